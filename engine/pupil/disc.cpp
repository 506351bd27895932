#include "engine/pupil/disc.h"

#include <cmath>

namespace lensproof::pupil {

Vec2d Disc::warped(double u, double v) const {
    const double a = 2.0 * u - 1.0;
    const double b = 2.0 * v - 1.0;
    if (a == 0.0 && b == 0.0) {
        return {};
    }
    constexpr double kQuarter = 0.25 * std::numbers::pi;
    const bool wide = std::abs(a) > std::abs(b);
    const double distance = radius * (wide ? a : b);
    const double angle = wide ? kQuarter * b / a : kQuarter * (2.0 - a / b);
    return {distance * std::cos(angle), distance * std::sin(angle)};
}

}  // namespace lensproof::pupil
