// engine/base/elementary.h — exponentials, sines and turns of the same bits on every machine, a GPU too.
//
// The libraries' own differ in their last bits from machine to machine. These are sums of products alone, which IEEE
// 754 rounds alike everywhere (nothing is contracted: CMakeLists.txt), in the lanes of a packet too.
#pragma once
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <type_traits>

#include "engine/base/select.h"
#include "engine/base/vec.h"

namespace lensproof {

namespace elementary_detail {

constexpr double factorial(int i) {
    return i < 2 ? 1.0 : i * factorial(i - 1);
}

/// 1/i! + p/(i + step)! + p²/(i + 2 step)! + … to the term of `last`, by Horner's rule.
template <int i, int last, int step, class T>
constexpr T factorial_series(const T& p) {
    using Number = typename LaneOf<T>::Number;
    constexpr auto kFirst = static_cast<Number>(1.0 / factorial(i));
    if constexpr (i < last) {
        return T(kFirst) + p * factorial_series<i + step, last, step>(p);
    } else {
        return T(kFirst);
    }
}

/// 1/i + p/(i + 2) + p²/(i + 4) + … to the term of `last`.
template <int i, int last, class T>
constexpr T odd_series(const T& p) {
    if constexpr (i < last) {
        return T(1.0 / i) + p * odd_series<i + 2, last>(p);
    } else {
        return T(1.0 / i);
    }
}

/// The nearest whole number, of |x| below 2^22 or, in double, 2^51.
template <class T>
constexpr T nearest_whole(const T& x) {
    using Number = typename LaneOf<T>::Number;
    const T no_digits_below_one(std::is_same_v<Number, double> ? Number(0x1.8p52) : Number(0x1.8p23));
    return (x + no_digits_below_one) - no_digits_below_one;
}

}  // namespace elementary_detail

/// e^x of |x| ≤ kNearZero as `exponential_of_negative` has it, of a number or of a packet's lanes.
template <class T>
constexpr T exponential_near_zero(const T& x) {
    return elementary_detail::factorial_series < 0, std::is_same_v<typename LaneOf<T>::Number, double> ? 14 : 8,
           1 > (x);
}
/// Below ln 2 / 2: no whole power of two is taken out.
template <std::floating_point Number>
inline constexpr auto kNearZero = Number(0.34);

/// e^x of x ≤ 0, for float and double: within 2 ulp, and 0 below the smallest normal number.
template <std::floating_point T>
constexpr T exponential_of_negative(const T& x) {
    constexpr bool is_double = std::is_same_v<T, double>;
    constexpr T kLeast = is_double ? T(-708.0) : T(-87.0);
    if (!(x >= kLeast)) {
        return x != x ? x : T(0);
    }
    // x = k ln 2 + r, |r| ≤ ln 2 / 2; the first part of ln 2 has so few digits that k times it is exact.
    constexpr T kLn2High = is_double ? T(0x1.62e42fefap-1) : T(0x1.62ep-1);
    constexpr T kLn2Low = is_double ? T(0x1.cf79abc9e3b3ap-40) : T(0x1.0bfbe8p-15);
    const int k = static_cast<int>(x * T(1.4426950408889634) - T(0.5));
    const T r = (x - T(k) * kLn2High) - T(k) * kLn2Low;
    const T of_rest = exponential_near_zero(r);
    if constexpr (is_double) {
        return of_rest * std::bit_cast<double>(static_cast<std::uint64_t>(1023 + k) << 52U);
    } else {
        return of_rest * std::bit_cast<float>(static_cast<std::uint32_t>(127 + k) << 23U);
    }
}

/// (cos x, sin x) of |x| ≤ π/4, each within 2 ulp: of a double or of a packet of them.
template <class T>
constexpr Vec2<T> cos_sin_within_eighth(const T& x) {
    const T minus_x2 = -(x * x);
    return {elementary_detail::factorial_series<0, 18, 2>(minus_x2),
            x * elementary_detail::factorial_series<1, 19, 2>(minus_x2)};
}

/// The largest |x| that `cos_sin_within` takes.
template <std::floating_point Number>
inline constexpr auto kMostTurned = std::is_same_v<Number, double> ? Number(1e6) : Number(6000);

/// (cos x, sin x) of |x| ≤ kMostTurned, each within an ulp of 1: of a number or of a packet's lanes.
template <class T>
constexpr Vec2<T> cos_sin_within(const T& x) {
    using Number = typename LaneOf<T>::Number;
    constexpr bool is_double = std::is_same_v<Number, double>;
    // Quarter turns in parts, of which the first ones have so few digits that multiples of them are exact.
    constexpr auto kFirst = Number(is_double ? 0x1.921fb544p+0 : 0x1.92p+0);
    constexpr auto kSecond = Number(is_double ? 0x1.0b4611a6p-34 : 0x1.fb6p-12);
    constexpr auto kThird = Number(is_double ? 0x1.3198a2e037073p-69 : -0x1.777a5cp-25);
    const T quarters = elementary_detail::nearest_whole(x * T(Number(0.63661977236758134308)));
    const T rest = ((x - quarters * T(kFirst)) - quarters * T(kSecond)) - quarters * T(kThird);
    const T minus_square = -(rest * rest);
    const T cosine = elementary_detail::factorial_series < 0, is_double ? 18 : 10, 2 > (minus_square);
    const T sine = rest * elementary_detail::factorial_series < 1, is_double ? 19 : 11, 2 > (minus_square);
    // −2 to 2 of them are left of whole turns.
    const T left = quarters - T(Number(4)) * elementary_detail::nearest_whole(quarters * T(Number(0.25)));
    const T half(Number(0.5));
    const auto is_odd = left * left > half && left * left < T(Number(2));
    const T along = select(is_odd, sine, cosine);
    const T across = select(is_odd, cosine, sine);
    return {select(left > half || left < -(T(Number(1)) + half), -along, along),
            select(left < -half || left > T(Number(1)) + half, -across, across)};
}

/// How far (x, y) is turned from +x towards +y, in [−1/2, 1/2] of a whole turn, within 2e-16; 0 of (0, 0). Of doubles.
template <class T>
constexpr T turns_of(const T& x, const T& y) {
    constexpr double kTan16 = 0.19891236737965800691;     // of π/16
    constexpr double kTan8 = 0.41421356237309504880;      // of π/8
    constexpr double kTan3Of16 = 0.66817863791929891999;  // of 3π/16
    constexpr double kTurn = 6.28318530717958647692;
    const T zero(0.0);
    const T across = select(x < zero, -x, x);
    const T along = select(y < zero, -y, y);
    const auto is_steep = along > across;
    const T small = select(is_steep, across, along);
    const T large = select(is_steep, along, across);
    // From the nearest of the directions of 0, π/8 and π/4, so that few terms are left.
    const auto is_past_first = small > T(kTan16) * large;
    const auto is_past_second = small > T(kTan3Of16) * large;
    const T tangent = select(is_past_second, T(1.0), select(is_past_first, T(kTan8), zero));
    const T from = select(is_past_second, T(0.125), select(is_past_first, T(0.0625), zero));
    const T denominator = large + tangent * small;
    const T t = (small - tangent * large) / select(denominator > zero, denominator, T(1.0));
    const T eighth = from + t * elementary_detail::odd_series<1, 21>(-(t * t)) * T(1.0 / kTurn);
    const T quarter = select(is_steep, T(0.25) - eighth, eighth);
    const T half = select(x < zero, T(0.5) - quarter, quarter);
    return select(y < zero, -half, half);
}

/// (cos x, sin x) of any x and any number type: beyond kMostTurned, and of other types, as their library has them.
template <class T>
constexpr Vec2<T> cos_sin(const T& x) {
    using std::cos;
    using std::sin;
    if constexpr (std::is_same_v<T, double> || std::is_same_v<T, float>) {
        if (x <= kMostTurned<T> && x >= -kMostTurned<T>) {
            return cos_sin_within(x);
        }
    }
    return {cos(x), sin(x)};
}

}  // namespace lensproof
