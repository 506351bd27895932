// engine/base/gather.h — numbers from a table for all lanes of a packet.
#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <experimental/simd>
#include <type_traits>
#ifdef __AVX__
#include <immintrin.h>
#endif

namespace lensproof {

/// table[index[lane]] for each of Lanes, a std::experimental::simd. Of bytes up to three more than asked for are read:
/// kBytesBeyond have to lie behind a table of them.
inline constexpr int kBytesBeyond = 3;
template <class Lanes, class Entry, class Number>
Lanes gathered(const Entry* table, const Number* index) {
    return Lanes([&](auto lane) { return static_cast<typename Lanes::value_type>(table[index[lane]]); });
}

#ifdef __AVX__
// Whole rows of four numbers are read and turned into columns, where g++ 12 would read number by number.
namespace avx {

// The address as what such an instruction takes, whatever its alignment.
template <typename Register>
const Register* any_address(const void* address) {
    return static_cast<const Register*>(address);
}

struct Columns {
    __m256d first;
    __m256d second;
    __m256d third;
    __m256d fourth;
};
struct FloatColumns {
    __m256 first;
    __m256 second;
    __m256 third;
    __m256 fourth;
};

template <class Row>
[[gnu::always_inline]] inline Columns columns_of_doubles(const Row* rows, const std::uint16_t* index) {
    const auto halves = [&](int lane, int from) {  // of that lane's row, and of the one after next's
        const auto half = [&](int of) { return _mm_loadu_pd(any_address<double>(rows + index[of]) + from); };
        return _mm256_insertf128_pd(_mm256_castpd128_pd256(half(lane)), half(lane + 2), 1);
    };
    return {_mm256_unpacklo_pd(halves(0, 0), halves(1, 0)), _mm256_unpackhi_pd(halves(0, 0), halves(1, 0)),
            _mm256_unpacklo_pd(halves(0, 2), halves(1, 2)), _mm256_unpackhi_pd(halves(0, 2), halves(1, 2))};
}

template <class Row>
[[gnu::always_inline]] inline FloatColumns columns_of_floats(const Row* rows, const std::uint16_t* index) {
    const auto two_rows = [&](int lane) {  // that lane's, and the fourth after
        const auto row = [&](int of) { return _mm_loadu_ps(any_address<float>(rows + index[of])); };
        return _mm256_insertf128_ps(_mm256_castps128_ps256(row(lane)), row(lane + 4), 1);
    };
    const auto low = [&](int lane) { return _mm256_castps_pd(_mm256_unpacklo_ps(two_rows(lane), two_rows(lane + 1))); };
    const auto high = [&](int lane) {
        return _mm256_castps_pd(_mm256_unpackhi_ps(two_rows(lane), two_rows(lane + 1)));
    };
    return {_mm256_castpd_ps(_mm256_unpacklo_pd(low(0), low(2))), _mm256_castpd_ps(_mm256_unpackhi_pd(low(0), low(2))),
            _mm256_castpd_ps(_mm256_unpacklo_pd(high(0), high(2))),
            _mm256_castpd_ps(_mm256_unpackhi_pd(high(0), high(2)))};
}

}  // namespace avx
#endif

#ifdef __AVX512F__
// The processor's own instruction, which g++ 12 does not make of the above: 1.2 ns in place of 1.9 ns for eight
// doubles.
namespace avx512 {

using Doubles = std::experimental::simd<double, std::experimental::simd_abi::native<double>>;
using Floats = std::experimental::simd<float, std::experimental::simd_abi::native<float>>;

using avx::any_address;

inline __m256i eight(const std::int32_t* index) {
    return _mm256_loadu_si256(any_address<__m256i>(index));
}
inline __m256i eight(const std::uint16_t* index) {
    return _mm256_cvtepu16_epi32(_mm_loadu_si128(any_address<__m128i>(index)));
}
inline __m512i sixteen(const std::uint16_t* index) {
    return _mm512_cvtepu16_epi32(_mm256_loadu_si256(any_address<__m256i>(index)));
}

inline Doubles joined(const __m256d& low, const __m256d& high) {
    return Doubles(static_cast<__m512d>(_mm512_insertf64x4(_mm512_castpd256_pd512(low), high, 1)));
}
inline Floats joined(const __m256& low, const __m256& high) {
    const __m512d both = _mm512_insertf64x4(_mm512_castps_pd(_mm512_castps256_ps512(low)), _mm256_castps_pd(high), 1);
    return Floats(static_cast<__m512>(_mm512_castpd_ps(both)));
}

}  // namespace avx512

template <>
inline avx512::Doubles gathered(const double* table, const std::int32_t* index) {
    return avx512::Doubles(static_cast<__m512d>(_mm512_i32gather_pd(avx512::eight(index), table, 8)));
}
template <>
inline avx512::Doubles gathered(const double* table, const std::uint16_t* index) {
    return avx512::Doubles(static_cast<__m512d>(_mm512_i32gather_pd(avx512::eight(index), table, 8)));
}
template <>
inline avx512::Doubles gathered(const std::int32_t* table, const std::int32_t* index) {
    return avx512::Doubles(
        static_cast<__m512d>(_mm512_cvtepi32_pd(_mm256_i32gather_epi32(table, avx512::eight(index), 4))));
}
template <>
inline avx512::Doubles gathered(const std::uint8_t* table, const std::int32_t* index) {
    const __m256i four_bytes =
        _mm256_i32gather_epi32(avx512::any_address<std::int32_t>(table), avx512::eight(index), 1);
    return avx512::Doubles(
        static_cast<__m512d>(_mm512_cvtepi32_pd(_mm256_and_si256(four_bytes, _mm256_set1_epi32(0xff)))));
}
template <>
inline avx512::Floats gathered(const float* table, const std::uint16_t* index) {
    return avx512::Floats(static_cast<__m512>(_mm512_i32gather_ps(avx512::sixteen(index), table, 4)));
}
#endif

/// The numbers of rows[index[lane]] for each of Lanes: all their first ones, all their second ones, …; a row is a
/// struct of four.
template <class Lanes, class Row>
std::array<Lanes, 4> gathered_rows(const Row* rows, const std::uint16_t* index) {
    using Number = typename Lanes::value_type;
    static_assert(sizeof(Row) == 4 * sizeof(Number));
#ifdef __AVX__
    constexpr auto kCount = Lanes::size();
    [[maybe_unused]] const auto columns = [&](int lane) {
        if constexpr (std::is_same_v<Number, double>) {
            return avx::columns_of_doubles(rows, index + lane);
        } else {
            return avx::columns_of_floats(rows, index + lane);
        }
    };
    if constexpr (kCount * sizeof(Number) == sizeof(__m256d)) {
        const auto all = columns(0);
        return {Lanes(all.first), Lanes(all.second), Lanes(all.third), Lanes(all.fourth)};
    }
#endif
#ifdef __AVX512F__
    if constexpr (kCount * sizeof(Number) == sizeof(__m512d)) {
        const auto low = columns(0);
        const auto high = columns(kCount / 2);
        return {avx512::joined(low.first, high.first), avx512::joined(low.second, high.second),
                avx512::joined(low.third, high.third), avx512::joined(low.fourth, high.fourth)};
    }
#endif
    const auto of = [&](std::size_t column) {
        return Lanes([&](auto lane) { return std::bit_cast<std::array<Number, 4>>(rows[index[lane]])[column]; });
    };
    return {of(0), of(1), of(2), of(3)};
}

}  // namespace lensproof
