// engine/render/sampling/packet/number_kernels.h — the numbers of many light paths, a loop for each width of packets.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "engine/base/simd_level.h"
#include "engine/render/sampling/path_sampler.h"

namespace lensproof::render {

/// Of samplers side by side what each says next, a column a number.
struct alignas(64) NumberColumns {
    static constexpr int kMost = 64;
    template <class Number>
    using Column = std::array<Number, kMost>;

    Column<std::uint64_t> seed{};
    Column<std::uint64_t> set{};
    Column<std::uint32_t> pixel{};
    Column<std::uint32_t> sample{};
    std::array<Column<double>, PathSampler::kNumbers> number;
    int size = 0;

    /// Adds what `sampler` says when it has been asked `sets` times more.
    void add(const PathSampler& sampler, std::uint64_t sets);
    [[nodiscard]] std::array<double, PathSampler::kNumbers> numbers(int i) const;
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
