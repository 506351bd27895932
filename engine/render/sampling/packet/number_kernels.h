// engine/render/sampling/packet/number_kernels.h — the numbers of many light paths, a loop for each width of packets.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "engine/base/disc.h"
#include "engine/base/simd_level.h"
#include "engine/render/sampling/path_sampler.h"

namespace lensproof::render {

/// Of samplers side by side what each says next, a column a number, of which paths take these at a surface: the first
/// ones for scattering there, the others for a light.
struct alignas(64) NumberColumns {
    static constexpr int kMost = 64;
    static constexpr int kNumbers = 4;
    static constexpr int kForLights = 3;  // of these
    static_assert(kNumbers <= PathSampler::kNumbers);
    template <class Number>
    using Column = std::array<Number, kMost>;

    Column<std::uint64_t> seed{};
    Column<std::uint64_t> set{};
    Column<std::uint32_t> pixel{};
    Column<std::uint32_t> sample{};
    std::array<Column<double>, kNumbers> number;
    std::array<Column<double>, 3> matt;  // cosine_direction of the second and third, for scattering
    int size = 0;
    int for_surfaces = 0;  // so many, the first ones, are for scattering

    /// Adds what `sampler` says when it has been asked `sets` times more.
    void add(const PathSampler& sampler, std::uint64_t sets);
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
