// engine/scene/light/packet/map_kernels.h — many directions of a map, a loop for each width of packets.
#pragma once
#include <array>
#include <cstddef>
#include <optional>

#include "engine/base/simd_level.h"
#include "engine/scene/light/packet/map_turns.h"

namespace lensproof::scene {

/// Directions and the points that show them (map_turns.h) side by side, a column a number.
struct alignas(64) MapColumns {
    static constexpr std::size_t kMost = 64;
    using Column = std::array<double, kMost>;

    Column x{}, y{}, z{}, sine{};
    Column at_x{}, at_y{};
    std::size_t size = 0;
};

/// The loops of one level; all levels yield the same bits, those of a single direction.
struct MapKernels {
    void (*find_directions)(MapColumns& columns);  // of the points
    void (*find_points)(MapColumns& columns);      // of the directions
};

/// Those of a level, or of the widest; throws as `LoopsByLevel` does.
const MapKernels& map_kernels(std::optional<SimdLevel> level = {});

/// Compiled for each level by itself (.ci/rooms.cmake).
template <SimdLevel level>
MapKernels map_kernels_at();

}  // namespace lensproof::scene
