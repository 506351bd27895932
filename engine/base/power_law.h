// engine/base/power_law.h — the exponent of a power law through points.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/vec.h"

namespace lensproof {

struct PowerLaw {
    double exponent = 0.0;
    double standard_error = 0.0;  // by how the points lie about it; of three points or more
};

/// y ~ x^exponent, by least squares of the logarithms; all numbers are positive.
inline PowerLaw power_law(const std::vector<Vec2d>& points) {
    const auto n = static_cast<double>(points.size());
    Vec2d mean;
    for (const Vec2d& point : points) {
        mean = mean + Vec2d{std::log(point.x), std::log(point.y)} / n;
    }
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (const Vec2d& point : points) {
        const Vec2d off = Vec2d{std::log(point.x), std::log(point.y)} - mean;
        xx += off.x * off.x;
        xy += off.x * off.y;
        yy += off.y * off.y;
    }
    const double exponent = xy / xx;
    return {exponent, points.size() > 2 ? std::sqrt(std::max(0.0, yy - exponent * xy) / (xx * (n - 2.0))) : 0.0};
}

}  // namespace lensproof
