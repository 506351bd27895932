// engine/scene/geometry/packet/analytic_kernel.h — many rays against spheres and quads, for compilers to vectorise.
//
// Only a file for each level includes this (.ci/rooms.cmake), compiled for its own instructions, so what it
// defines must not be shared with code for other machines: everything here is a template over the packs' Abi, and
// inlined.
#pragma once
#include "engine/base/pack.h"
#include "engine/scene/geometry/packet/analytic_kernels.h"

namespace lensproof::scene {

template <class Numbers>
Vec3<Numbers> load_vector(const RayColumns::Column& x, const RayColumns::Column& y, const RayColumns::Column& z,
                          std::size_t i) {
    return {Numbers::load(x.data() + i), Numbers::load(y.data() + i), Numbers::load(z.data() + i)};
}

template <class Abi>
[[gnu::flatten]] void meet_nearest(std::span<const AnalyticObject> objects, RayColumns& rays) {
    using Numbers = Pack<double, Abi>;
    const auto blend = [](const auto& mask, const Numbers& value, double* column) {
        select(mask, value, Numbers::load(column)).store(column);
    };
    for (std::size_t k = 0; k < objects.size(); ++k) {
        for (std::size_t i = 0; i < rays.size; i += Numbers::kLanes) {
            const Crossing<Numbers> crossing =
                meet(objects[k],
                     Stretch<Numbers>{
                         .origin = load_vector<Numbers>(rays.origin_x, rays.origin_y, rays.origin_z, i),
                         .direction = load_vector<Numbers>(rays.direction_x, rays.direction_y, rays.direction_z, i),
                         .from = Numbers::load(rays.from.data() + i),
                         .to = Numbers::load(rays.to.data() + i)});
            if (any(crossing.is_met)) {
                blend(crossing.is_met, crossing.meeting.at, rays.to.data() + i);
                blend(crossing.is_met, crossing.meeting.b1, rays.b1.data() + i);
                blend(crossing.is_met, crossing.meeting.b2, rays.b2.data() + i);
                blend(crossing.is_met, Numbers(static_cast<double>(k)), rays.object.data() + i);
            }
        }
    }
}

template <>
AnalyticKernels analytic_kernels_at<SimdLevel::LENSPROOF_LEVEL>() {
    using Abi = AbiOf<SimdLevel::LENSPROOF_LEVEL, double>;
    return {.meet_nearest = meet_nearest<Abi>};
}

}  // namespace lensproof::scene
