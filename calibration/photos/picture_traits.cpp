#include "calibration/photos/picture_traits.h"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "calibration/photos/flat_field_traits.h"

namespace lensproof {
namespace {

constexpr double kSteepest = 0.98;       // of the pixels around a point are less steep than the edge's middle
constexpr double kAboveNoise = 5.0;      // that an edge has to be for its blur to be told
constexpr int kFarthest_px = 40;         // looked at around a point; more pixels tell no more
constexpr double kMedianOfAbs = 0.6745;  // of a normal distribution, in standard deviations

double percentile(std::vector<double>& values, double share) {
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, place);
    return *place;
}

// Half the way to the nearest other point that was found.
int reach_px(const ChartPoints& points, std::size_t i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < points.image_px.size(); ++j) {
        if (j != i && points.found[j]) {
            nearest = std::min(nearest, std::hypot(points.image_px[j].x - points.image_px[i].x,
                                                   points.image_px[j].y - points.image_px[i].y));
        }
    }
    return static_cast<int>(std::min<double>(kFarthest_px, 0.5 * nearest));
}

/// Immerkaer's mask.
double laplacian_at(const Image& image, int channel, int x, int y) {
    const auto at = [&](int dx, int dy) { return static_cast<double>(image.at(x + dx, y + dy, channel)); };
    return at(-1, -1) + at(1, -1) + at(-1, 1) + at(1, 1) - 2.0 * (at(0, -1) + at(-1, 0) + at(1, 0) + at(0, 1)) +
           4.0 * at(0, 0);
}

/// From the median of its absolute value, were the noise normal: the mask's weights have squares that sum to 36.
double noise_of(double median_laplacian) {
    return median_laplacian / (6.0 * kMedianOfAbs);
}

struct Window {
    double white;
    double black;
    double laplacian;  // median of its absolute value
    double steepest;   // change over 2 px
};

std::optional<Window> look_around(const Image& image, int channel, const Vec2d& point, int reach) {
    const int x0 = std::max(1, static_cast<int>(std::lround(point.x)) - reach);
    const int x1 = std::min(image.width - 2, static_cast<int>(std::lround(point.x)) + reach);
    const int y0 = std::max(1, static_cast<int>(std::lround(point.y)) - reach);
    const int y1 = std::min(image.height - 2, static_cast<int>(std::lround(point.y)) + reach);
    std::vector<double> tones;
    std::vector<double> laplacians;
    std::vector<double> steps;
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
            const auto at = [&](int dx, int dy) { return static_cast<double>(image.at(x + dx, y + dy, channel)); };
            const double laplacian = laplacian_at(image, channel, x, y);
            const double step = std::hypot(at(1, 0) - at(-1, 0), at(0, 1) - at(0, -1));
            if (std::isfinite(laplacian) && std::isfinite(step)) {
                tones.push_back(at(0, 0));
                laplacians.push_back(std::abs(laplacian));
                steps.push_back(step);
            }
        }
    }
    if (tones.size() < 25) {
        return std::nullopt;
    }
    return Window{percentile(tones, 0.95), percentile(tones, 0.05), percentile(laplacians, 0.5),
                  percentile(steps, kSteepest)};
}

double median_of(const std::vector<Window>& windows, double Window::*member) {
    std::vector<double> values;
    values.reserve(windows.size());
    for (const Window& window : windows) {
        values.push_back(window.*member);
    }
    return percentile(values, 0.5);
}

}  // namespace

std::optional<PictureTraits> picture_traits(const Image& image, int channel, const ChartPoints& points) {
    std::vector<Window> windows;
    std::vector<double> blurs;
    for (std::size_t i = 0; i < points.image_px.size(); ++i) {
        if (const auto window =
                points.found[i] ? look_around(image, channel, points.image_px[i], reach_px(points, i)) : std::nullopt) {
            windows.push_back(*window);
        }
    }
    if (windows.empty()) {
        return std::nullopt;
    }
    PictureTraits traits{.white = median_of(windows, &Window::white),
                         .black = median_of(windows, &Window::black),
                         .noise = noise_of(median_of(windows, &Window::laplacian)),
                         .blur_px = {}};
    for (const Window& window : windows) {
        const double contrast = window.white - window.black;
        if (contrast > kAboveNoise * traits.noise && window.steepest > kAboveNoise * traits.noise) {
            const double share = std::min(window.steepest / contrast, 1.0 - 1e-6);
            blurs.push_back(1.0 / (std::numbers::sqrt2 * boost::math::erf_inv(share)));
        }
    }
    if (2 * blurs.size() > windows.size()) {
        traits.blur_px = percentile(blurs, 0.5);
    }
    return traits;
}

FlatFieldTraits flat_field_traits(const Image& image, int channel) {
    constexpr int kSmallest_px = 8;
    constexpr int kParts = 40;  // of a side, of which the middle two are looked at
    if (image.width < kSmallest_px || image.height < kSmallest_px) {
        return {};
    }
    std::vector<double> laplacians;
    laplacians.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    double sum = 0.0;
    int count = 0;
    for (int y = 1; y + 1 < image.height; ++y) {
        for (int x = 1; x + 1 < image.width; ++x) {
            const double laplacian = laplacian_at(image, channel, x, y);
            if (!std::isfinite(laplacian)) {
                continue;
            }
            laplacians.push_back(std::abs(laplacian));
            const bool in_middle = std::abs(2 * x - image.width) <= std::max(2, image.width / (kParts / 2)) &&
                                   std::abs(2 * y - image.height) <= std::max(2, image.height / (kParts / 2));
            sum += in_middle ? static_cast<double>(image.at(x, y, channel)) : 0.0;
            count += in_middle ? 1 : 0;
        }
    }
    if (count == 0) {
        return {};
    }
    return {.white = sum / count, .noise = noise_of(percentile(laplacians, 0.5))};
}

}  // namespace lensproof
