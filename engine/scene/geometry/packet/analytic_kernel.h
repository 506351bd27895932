// engine/scene/geometry/packet/analytic_kernel.h — rays against spheres, quads and triangles, for compilers to
// vectorise.
//
// Only a file for each level includes this (.ci/rooms.cmake), compiled for its own instructions, so what it
// defines must not be shared with code for other machines: everything here is a template over the packs' Abi, and
// inlined.
#pragma once
#include "engine/base/pack.h"
#include "engine/scene/geometry/packet/analytic_kernels.h"

namespace lensproof::scene {

template <class Numbers, class Column>
Vec3<Numbers> load_vector(const Column& x, const Column& y, const Column& z, std::size_t i) {
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

template <class Numbers>
LaneFunction<Numbers> load_function(const TriangleBlock::Function& function, std::size_t lane) {
    return {.gradient = load_vector<Numbers>(function.x, function.y, function.z, lane),
            .at_origin = Numbers::load(function.at_origin.data() + lane)};
}

template <class Abi>
[[gnu::flatten]] TriangleMeeting meet_first_triangle(std::span<const TriangleBlock> blocks, const Stretch<double>& ray,
                                                     double reach_mm) {
    using Numbers = Pack<double, Abi>;
    const auto everywhere = [](const Vec3d& v) { return Vec3<Numbers>{Numbers(v.x), Numbers(v.y), Numbers(v.z)}; };
    Stretch<Numbers> rays{.origin = everywhere(ray.origin),
                          .direction = everywhere(ray.direction),
                          .from = Numbers(ray.from),
                          .to = Numbers(ray.to)};
    Numbers b1(0.0);
    Numbers b2(0.0);
    Numbers triangle(-1.0);
    Numbers here = Numbers::iota();
    for (const TriangleBlock& block : blocks) {
        for (std::size_t lane = 0; lane < TriangleBlock::kLanes; lane += Numbers::kLanes) {
            const auto [is_met, meeting] =
                meet_triangles(load_function<Numbers>(block.height, lane), load_function<Numbers>(block.b1, lane),
                               load_function<Numbers>(block.b2, lane), Numbers::load(block.b1_slope.data() + lane),
                               Numbers::load(block.b2_slope.data() + lane), reach_mm, rays);
            rays.to = select(is_met, meeting.at, rays.to);
            b1 = select(is_met, meeting.b1, b1);
            b2 = select(is_met, meeting.b2, b2);
            triangle = select(is_met, here, triangle);
            here = here + Numbers(Numbers::kLanes);
        }
    }
    TriangleMeeting first;
    for (int lane = 0; lane < Numbers::kLanes; ++lane) {
        const int index = static_cast<int>(triangle[lane]);
        const double at = rays.to[lane];
        const bool is_before = at < first.meeting.at || (at == first.meeting.at && index < first.triangle);
        if (index >= 0 && (first.triangle < 0 || is_before)) {
            first = {.meeting = {.at = at, .b1 = b1[lane], .b2 = b2[lane]}, .triangle = index};
        }
    }
    return first;
}

template <>
AnalyticKernels analytic_kernels_at<SimdLevel::LENSPROOF_LEVEL>() {
    using Abi = AbiOf<SimdLevel::LENSPROOF_LEVEL, double>;
    return {.meet_nearest = meet_nearest<Abi>, .meet_first_triangle = meet_first_triangle<Abi>};
}

}  // namespace lensproof::scene
