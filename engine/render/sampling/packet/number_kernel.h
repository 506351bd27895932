// engine/render/sampling/packet/number_kernel.h — the numbers of many light paths, for compilers to vectorise.
//
// Only a file for each level includes this (.ci/rooms.cmake), compiled for its own instructions, so what it
// defines must not be shared with code for other machines: everything here is a template over the packs' Abi, and
// inlined.
#pragma once
#include "engine/base/pack.h"
#include "engine/render/sampling/packet/number_kernels.h"

namespace lensproof::render {

/// As PathSampler says them, in loops over all that wait for no look-up.
template <class Abi, class NumberAbi>
[[gnu::flatten]] void draw_numbers(NumberColumns& columns) {
    using Words = std::experimental::simd<std::uint32_t, Abi>;
    constexpr std::experimental::vector_aligned_tag kAligned;
    constexpr int kMost = NumberColumns::kMost;
    constexpr int kDimensions = NumberColumns::kNumbers;
    constexpr int kStep = 16;
    const int end = (columns.size + kStep - 1) / kStep * kStep;  // whole packets
    alignas(64) std::uint64_t stream[kMost];
    alignas(64) std::uint32_t index[kMost];
    for (int i = 0; i < end; ++i) {
        const std::uint64_t own = PathSampler::own_seed(columns.seed[i], columns.set[i]);
        stream[i] = PixelSampler::stream(own, columns.pixel[i]);
        index[i] = PathSampler::shuffled(columns.sample[i], PathSampler::shuffle(own, columns.pixel[i]));
    }
    alignas(64) std::uint32_t point[kDimensions][kMost];
    for (int i = 0; i < end; i += static_cast<int>(Words::size())) {
        const Words bits(index + i, kAligned);
        Words of[kDimensions] = {};
        for (int bit = 0; bit < 32; ++bit) {
            const Words mask = Words(0U) - ((bits >> bit) & Words(1U));
            for (int d = 0; d < kDimensions; ++d) {
                of[d] ^= mask & Words(sampler_detail::kReversedDirections[d][bit]);
            }
        }
        for (int d = 0; d < kDimensions; ++d) {
            of[d].copy_to(point[d] + i, kAligned);
        }
    }
    for (int d = 0; d < kDimensions; ++d) {
        for (int i = 0; i < end; ++i) {
            columns.number[d][i] = sampler_detail::scrambled_number(point[d][i], PixelSampler::scramble(stream[i], d));
        }
    }
    using Numbers = Pack<double, NumberAbi>;
    for (int i = 0; i < columns.with_matt; i += Numbers::kLanes) {
        const Vec3<Numbers> matt =
            cosine_direction(Numbers::load(columns.number[1].data() + i), Numbers::load(columns.number[2].data() + i));
        matt.x.store(columns.matt[0].data() + i);
        matt.y.store(columns.matt[1].data() + i);
        matt.z.store(columns.matt[2].data() + i);
    }
}

template <>
NumberKernels number_kernels_at<SimdLevel::LENSPROOF_LEVEL>() {
    using Abi = AbiOf<SimdLevel::LENSPROOF_LEVEL, std::uint32_t>;
    return {.draw = draw_numbers<Abi, AbiOf<SimdLevel::LENSPROOF_LEVEL, double>>};
}

}  // namespace lensproof::render
