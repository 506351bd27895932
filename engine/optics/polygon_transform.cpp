#include "engine/optics/polygon_transform.h"

#include <cmath>

namespace lensproof::optics {

namespace {

double sinc(double x) {
    return std::abs(x) < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x;
}

}  // namespace

std::complex<double> polygon_transform(std::span<const Vec2d> corners, const Vec2d& k) {
    const double k2 = k.x * k.x + k.y * k.y;
    std::complex<double> sum = 0.0;
    double twice_area = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec2d& a = corners[i];
        const Vec2d& b = corners[(i + 1) % corners.size()];
        const Vec2d edge{b.x - a.x, b.y - a.y};
        const Vec2d middle{0.5 * (a.x + b.x), 0.5 * (a.y + b.y)};
        twice_area += cross(a, b);
        sum += cross(k, edge) * sinc(0.5 * (k.x * edge.x + k.y * edge.y)) *
               std::polar(1.0, -(k.x * middle.x + k.y * middle.y));
    }
    const double turn = std::copysign(1.0, twice_area);
    return k2 > 0.0 ? turn * std::complex<double>(0.0, 1.0) * sum / k2 : std::complex<double>(0.5 * turn * twice_area);
}

}  // namespace lensproof::optics
