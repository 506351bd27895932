// Pictures of one edge whose modulation transfer function is known in closed form.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "calibration/sharpness/slanted_edge.h"
#include "engine/base/angle.h"
#include "engine/base/bisect.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::synthetic {

/// A blur by its edge-spread function along the normal (from 0 to 1) and its MTF; the pixel's box is not part of it.
struct Blur {
    std::function<double(double)> edge_spread;
    std::function<double(double)> mtf;
};

inline double normal_cdf(double x) {
    return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

inline Blur gaussian_blur(double sigma) {
    return {[=](double x) { return normal_cdf(x / sigma); },
            [=](double f) { return std::exp(-2.0 * std::pow(std::numbers::pi * sigma * f, 2)); }};
}

/// A Gaussian convolved with a one-sided exponential, as coma smears.
inline Blur smeared_blur(double sigma, double tail) {
    return {[=](double x) {
                return normal_cdf(x / sigma) -
                       std::exp(0.5 * sigma * sigma / (tail * tail) - x / tail) * normal_cdf(x / sigma - sigma / tail);
            },
            [=](double f) {
                const double w = 2.0 * std::numbers::pi * f;
                return std::exp(-0.5 * w * w * sigma * sigma) / std::hypot(1.0, w * tail);
            }};
}

/// No blur but the pixel's own box.
inline Blur no_blur() {
    return {[](double x) { return x < 0.0 ? 0.0 : 1.0; }, [](double) { return 1.0; }};
}

struct EdgePicture {
    double normal_deg = 5.0;  // from dark to bright
    double dark = 0.04;
    double bright = 0.9;
    double curvature = 0.0;  // 1/px: the edge is a parabola
    int width = 60;
    int height = 80;
    Vec2d middle{29.6, 39.3};  // on the edge
    std::function<double(const Vec2d&)> light = [](const Vec2d&) { return 1.0; };
};

/// Pixels are exact integrals of the blurred edge over their box, by n × n cells of 2 × 2 Gauss-Legendre
/// points.
inline formats::Image paint_edge(const EdgePicture& edge, const Blur& blur, int n = 4) {
    const double a = radians(edge.normal_deg);
    formats::Image image = formats::make_image(edge.width, edge.height, {"Y"});
    for (int y = 0; y < edge.height; ++y) {
        for (int x = 0; x < edge.width; ++x) {
            double sum = 0.0;
            for (int i = 0; i < 4 * n * n; ++i) {
                const auto offset = [&](int k) {
                    const int cell = k / 2;
                    return (cell + 0.5 + (k % 2 == 0 ? -0.5 : 0.5) / std::numbers::sqrt3) / n - 0.5;
                };
                const double dx = x + offset(i % (2 * n)) - edge.middle.x;
                const double dy = y + offset(i / (2 * n)) - edge.middle.y;
                const double along = -dx * std::sin(a) + dy * std::cos(a);
                sum += blur.edge_spread(dx * std::cos(a) + dy * std::sin(a) - 0.5 * edge.curvature * along * along);
            }
            const double fraction = sum / (4.0 * n * n);
            image.at(x, y, 0) = static_cast<float>(std::lerp(edge.dark, edge.bright, fraction) *
                                                   edge.light({static_cast<double>(x), static_cast<double>(y)}));
        }
    }
    return image;
}

/// The blur's MTF times that of the pixel's box along the normal.
inline double true_mtf(const Blur& blur, double normal_deg, double frequency) {
    const auto sinc = [](double x) { return std::abs(x) > 1e-12 ? std::sin(x) / x : 1.0; };
    const double a = radians(normal_deg);
    const double w = std::numbers::pi * frequency;
    return std::abs(blur.mtf(frequency) * sinc(w * std::cos(a)) * sinc(w * std::sin(a)));
}

/// Where the true MTF falls to `level`, by bisection on its first descent.
inline double true_frequency(const Blur& blur, double normal_deg, double level) {
    const auto is_above = [&](double frequency) { return true_mtf(blur, normal_deg, frequency) > level; };
    double high = 0.0;
    while (is_above(high)) {
        high += 1e-3;
    }
    return bisected({high - 1e-3, high}, 40, is_above).inside;
}

inline EdgeRegion region_of(const EdgePicture& edge, double half_length = 32.0, double half_width = 20.0) {
    const double a = radians(edge.normal_deg);
    return {edge.middle, {-std::sin(a), std::cos(a)}, half_length, half_width};
}

}  // namespace lensproof::calibration::synthetic
