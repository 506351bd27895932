// engine/render/sampling/packet/number_kernel.h — the numbers of many light paths, for compilers to vectorise.
//
// Only a file for each level includes this (.ci/rooms.cmake), compiled for its own instructions, so what it
// defines must not be shared with code for other machines: everything here is a template over the packs' Abi, and
// inlined.
#pragma once
#include "engine/base/pack.h"
#include "engine/render/sampling/packet/number_kernels.h"
#include "engine/render/sampling/packet/sobol_packet.h"

namespace lensproof::render {

/// The first numbers of the set that each sampler says as the n-th from now on, in loops over all that wait for no
/// look-up.
template <class Abi, std::size_t numbers>
void draw_set(const NumberColumns& columns, std::uint64_t n, NumberColumns::Set<numbers>& set) {
    using Words = std::experimental::simd<std::uint32_t, Abi>;
    constexpr std::experimental::vector_aligned_tag kAligned;
    constexpr int kStep = 16;
    const int end = (columns.size + kStep - 1) / kStep * kStep;  // whole packets
    alignas(64) std::uint64_t stream[NumberColumns::kMost];
    alignas(64) std::uint32_t point[numbers][NumberColumns::kMost];
    for (int i = 0; i < end; ++i) {
        const std::uint64_t own = PathSampler::own_seed(columns.seed[i], columns.set[i] + n);
        stream[i] = PixelSampler::stream(own, columns.pixel[i]);
        point[0][i] = PathSampler::shuffled(columns.sample[i], PathSampler::shuffle(own, columns.pixel[i]));
    }
    for (int i = 0; i < end; i += static_cast<int>(Words::size())) {
        const Words samples(point[0] + i, kAligned);  // of which these are the points in the first dimension
        for (int d = 1; d < static_cast<int>(numbers); ++d) {
            sobol::points(samples, d).copy_to(point[d] + i, kAligned);
        }
    }
    for (int d = 0; d < static_cast<int>(numbers); ++d) {
        for (int i = 0; i < end; ++i) {
            set[d][i] = sampler_detail::scrambled_number(point[d][i], PixelSampler::scramble(stream[i], d));
        }
    }
}

template <class Abi, class NumberAbi>
[[gnu::flatten]] void draw_numbers(NumberColumns& columns) {
    draw_set<Abi>(columns, 1, columns.next);
    draw_set<Abi>(columns, 2, columns.after);
    using Numbers = Pack<double, NumberAbi>;
    for (int i = 0; i < columns.size; i += Numbers::kLanes) {
        const Vec3<Numbers> matt =
            cosine_direction(Numbers::load(columns.next[1].data() + i), Numbers::load(columns.next[2].data() + i));
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
