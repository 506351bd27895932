// engine/base/angle.h — angles in degrees, which people state, and in radians, which all code here computes with.
#pragma once
#include <numbers>

namespace lensproof {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180.0;  // rad: 30.0 * kDegree, angle / kDegree

/// Rounded in this order; a product with kDegree may be an ulp off.
constexpr double radians(double degrees) {
    return degrees * kPi / 180.0;
}
constexpr double degrees(double radians) {
    return radians * 180.0 / kPi;
}

}  // namespace lensproof
