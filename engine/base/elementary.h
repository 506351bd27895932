// engine/base/elementary.h — exponentials and sines of the same bits on every machine, a GPU too.
//
// The libraries' own differ in their last bits from machine to machine. These are sums of products alone, which IEEE
// 754 rounds alike everywhere (nothing is contracted: CMakeLists.txt).
#pragma once
#include <bit>
#include <concepts>
#include <cstdint>
#include <type_traits>

#include "engine/base/vec.h"

namespace lensproof {

namespace elementary_detail {

constexpr double factorial(int i) {
    return i < 2 ? 1.0 : i * factorial(i - 1);
}

/// 1/i! + p/(i + step)! + p²/(i + 2 step)! + … to the term of `last`, by Horner's rule.
template <int i, int last, int step, std::floating_point T>
constexpr T factorial_series(const T& p) {
    constexpr T kFirst = T(1.0 / factorial(i));
    if constexpr (i < last) {
        return kFirst + p * factorial_series<i + step, last, step>(p);
    } else {
        return kFirst;
    }
}

}  // namespace elementary_detail

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
    const T of_rest = elementary_detail::factorial_series < 0, is_double ? 14 : 8, 1 > (r);
    if constexpr (is_double) {
        return of_rest * std::bit_cast<double>(static_cast<std::uint64_t>(1023 + k) << 52U);
    } else {
        return of_rest * std::bit_cast<float>(static_cast<std::uint32_t>(127 + k) << 23U);
    }
}

/// (cos x, sin x) of |x| ≤ π/4, each within 2 ulp.
constexpr Vec2d cos_sin_within_eighth(double x) {
    const double minus_x2 = -(x * x);
    return {elementary_detail::factorial_series<0, 18, 2>(minus_x2),
            x * elementary_detail::factorial_series<1, 19, 2>(minus_x2)};
}

}  // namespace lensproof
