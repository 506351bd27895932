// engine/base/infinity.h — the numbers that are none: how far the sun is, and what was not measured.
#pragma once
#include <limits>

namespace lensproof {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace lensproof
