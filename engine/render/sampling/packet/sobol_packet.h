// engine/render/sampling/packet/sobol_packet.h — points of the Sobol sequence for all lanes of a packet.
//
// For the files of each level alone, as number_kernel.h.
#pragma once
#include <array>
#include <cstdint>
#include <experimental/simd>
#ifdef __AVX2__
#include <immintrin.h>
#endif

#include "engine/render/sampling/sampler.h"

namespace lensproof::render::sobol {

#ifdef __AVX2__
using WidestWords = std::experimental::simd<std::uint32_t, std::experimental::simd_abi::native<std::uint32_t>>;
#endif

/// Digits of how many bits a packet of Words, a std::experimental::simd of 32 bits each, looks up in one instruction,
/// in a table that fills a register.
template <class Words>
inline constexpr int kDigitBits = 1;

/// table[digit] for each lane, whose lowest kDigitBits are the digit; table[0] is 0.
template <class Words>
Words look_up(const std::array<std::uint32_t, 2>& table, const Words& digits) {
    return (Words(0U) - (digits & Words(1U))) & Words(table[1]);
}
#ifdef __AVX512F__
template <>
inline constexpr int kDigitBits<WidestWords> = 4;
inline WidestWords look_up(const std::array<std::uint32_t, 16>& table, const WidestWords& digits) {
    const __m512i entries = _mm512_loadu_si512(table.data());
    return WidestWords(static_cast<__m512i>(_mm512_permutexvar_epi32(static_cast<__m512i>(digits), entries)));
}
#elif defined(__AVX2__)
template <>
inline constexpr int kDigitBits<WidestWords> = 3;
inline WidestWords look_up(const std::array<std::uint32_t, 8>& table, const WidestWords& digits) {
    const __m256i entries = _mm256_loadu_si256(static_cast<const __m256i*>(static_cast<const void*>(table.data())));
    return WidestWords(static_cast<__m256i>(_mm256_permutevar8x32_epi32(entries, static_cast<__m256i>(digits))));
}
#endif

/// The points of the samples of `bits` bits at each of their places, a table for each in every dimension, as
/// `sampler_detail::sobol_point` has them.
template <int bits>
struct Digits {
    static constexpr int kPlaces = (32 + bits - 1) / bits;
    using Table = std::array<std::uint32_t, 1U << bits>;
    std::array<std::array<Table, kPlaces>, sampler_detail::kDimensions> of{};

    constexpr Digits() {
        for (int place = 0; place < kPlaces; ++place) {
            for (std::uint32_t digit = 0; digit < 1U << bits; ++digit) {
                const sampler_detail::PointBits x = sampler_detail::sobol_point(digit << (bits * place));
                for (int d = 0; d < sampler_detail::kDimensions; ++d) {
                    of[d][place][digit] = x[d];
                }
            }
        }
    }
};

/// The samples' points in the dimension `d`. In the first they are the samples themselves.
template <class Words>
Words points(const Words& samples, int d) {
    constexpr int kBits = kDigitBits<Words>;
    static constexpr Digits<kBits> kDigits;
    Words bits = 0;
    for (int place = 0; place < kDigits.kPlaces; ++place) {
        bits ^= look_up(kDigits.of[d][place], samples >> (kBits * place));
    }
    return bits;
}

}  // namespace lensproof::render::sobol
