// engine/scene/light/packet/map_kernel.h — many directions of a map, for compilers to vectorise.
//
// Only a file for each level includes this (.ci/rooms.cmake), compiled for its own instructions, so what it
// defines must not be shared with code for other machines: everything here is a template over the packs' Abi, and
// inlined.
#pragma once
#include "engine/base/pack.h"
#include "engine/scene/light/packet/map_kernels.h"

namespace lensproof::scene {

template <class Abi>
[[gnu::flatten]] void find_directions(MapColumns& columns) {
    using Numbers = Pack<double, Abi>;
    for (std::size_t i = 0; i < columns.size; i += Numbers::kLanes) {
        const MapDirection<Numbers> found = map_direction(
            Vec2<Numbers>{Numbers::load(columns.at_x.data() + i), Numbers::load(columns.at_y.data() + i)});
        found.direction.x.store(columns.x.data() + i);
        found.direction.y.store(columns.y.data() + i);
        found.direction.z.store(columns.z.data() + i);
        found.sine.store(columns.sine.data() + i);
    }
}

template <class Abi>
[[gnu::flatten]] void find_points(MapColumns& columns) {
    using Numbers = Pack<double, Abi>;
    for (std::size_t i = 0; i < columns.size; i += Numbers::kLanes) {
        const MapPoint<Numbers> found =
            map_point(Vec3<Numbers>{Numbers::load(columns.x.data() + i), Numbers::load(columns.y.data() + i),
                                    Numbers::load(columns.z.data() + i)});
        found.at.x.store(columns.at_x.data() + i);
        found.at.y.store(columns.at_y.data() + i);
        found.sine.store(columns.sine.data() + i);
    }
}

template <>
MapKernels map_kernels_at<SimdLevel::LENSPROOF_LEVEL>() {
    using Abi = AbiOf<SimdLevel::LENSPROOF_LEVEL, double>;
    return {.find_directions = find_directions<Abi>, .find_points = find_points<Abi>};
}

}  // namespace lensproof::scene
