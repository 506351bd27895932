// engine/render/sampling/packet/number_kernels.h — the numbers of many light paths, a loop for each width of packets.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "engine/base/disc.h"
#include "engine/base/simd_level.h"
#include "engine/render/sampling/path_sampler.h"

namespace lensproof::render {

/// Of samplers side by side what each says next, a column a number: as many as a path takes at a surface.
struct alignas(64) NumberColumns {
    static constexpr int kMost = 32;
    template <class Number>
    using Column = std::array<Number, kMost>;
    template <std::size_t numbers>
    using Set = std::array<Column<double>, numbers>;

    Column<std::uint64_t> seed{};
    Column<std::uint64_t> set{};
    Column<std::uint32_t> pixel{};
    Column<std::uint32_t> sample{};
    Set<4> next;   // of each sampler's next set, for scattering
    Set<3> matt;   // cosine_direction of its second and third number
    Set<3> after;  // of the set after that, for a light
    int size = 0;

    void add(const PathSampler& sampler);
    [[nodiscard]] Vec3d matt_direction(std::size_t i) const { return {matt[0][i], matt[1][i], matt[2][i]}; }
};

/// The loops of one level; all levels yield the same bits.
struct NumberKernels {
    void (*draw)(NumberColumns& columns);
};

/// Those of a level, or of the widest; throws as `LoopsByLevel` does.
const NumberKernels& number_kernels(std::optional<SimdLevel> level = {});

/// Compiled for each level by itself (.ci/rooms.cmake).
template <SimdLevel level>
NumberKernels number_kernels_at();

}  // namespace lensproof::render
