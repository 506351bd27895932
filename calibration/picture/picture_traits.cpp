#include "calibration/picture/picture_traits.h"

#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "calibration/detection/pixel_noise.h"
#include "engine/base/order_statistics.h"

namespace lensproof::calibration {
namespace {

constexpr double kSteepest = 0.98;   // of the pixels around a point are less steep than the edge's middle
constexpr double kAboveNoise = 5.0;  // that an edge has to be for its blur to be told

struct EdgeWindow {
    double white;
    double black;
    double steepest;  // change over 2 px
};

std::optional<EdgeWindow> look_around(const formats::Image& image, int channel, const Vec2d& point, int reach) {
    const int x0 = std::max(1, static_cast<int>(std::lround(point.x)) - reach);
    const int x1 = std::min(image.width - 2, static_cast<int>(std::lround(point.x)) + reach);
    const int y0 = std::max(1, static_cast<int>(std::lround(point.y)) - reach);
    const int y1 = std::min(image.height - 2, static_cast<int>(std::lround(point.y)) + reach);
    std::vector<double> tones;
    std::vector<double> steps;
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
            const auto at = [&](int dx, int dy) { return static_cast<double>(image.at(x + dx, y + dy, channel)); };
            const double step = std::hypot(at(1, 0) - at(-1, 0), at(0, 1) - at(0, -1));
            if (std::isfinite(step) && std::isfinite(at(0, 0))) {
                tones.push_back(at(0, 0));
                steps.push_back(step);
            }
        }
    }
    if (tones.size() < 25) {
        return std::nullopt;
    }
    return EdgeWindow{quantile(tones, 0.95), quantile(tones, 0.05), quantile(steps, kSteepest)};
}

double median_of(const std::vector<EdgeWindow>& windows, double EdgeWindow::*member) {
    std::vector<double> values;
    values.reserve(windows.size());
    for (const EdgeWindow& window : windows) {
        values.push_back(window.*member);
    }
    return quantile(values, 0.5);
}

}  // namespace

std::optional<PictureTraits> picture_traits(const formats::Image& image, int channel, const ChartPoints& points) {
    std::vector<EdgeWindow> windows;
    std::vector<double> blurs;
    for (std::size_t i = 0; i < points.image_px.size(); ++i) {
        if (const auto window = points.found[i]
                                    ? look_around(image, channel, points.image_px[i], neighbourhood_px(points, i))
                                    : std::nullopt) {
            windows.push_back(*window);
        }
    }
    if (windows.empty()) {
        return std::nullopt;
    }
    PictureTraits traits{.white = median_of(windows, &EdgeWindow::white),
                         .black = median_of(windows, &EdgeWindow::black),
                         .noise = pixel_noise(image, channel, points),
                         .blur_px = {}};
    for (const EdgeWindow& window : windows) {
        const double contrast = window.white - window.black;
        if (contrast > kAboveNoise * traits.noise && window.steepest > kAboveNoise * traits.noise) {
            const double steepest_of_contrast = std::min(window.steepest / contrast, 1.0 - 1e-6);
            blurs.push_back(1.0 / (std::numbers::sqrt2 * boost::math::erf_inv(steepest_of_contrast)));
        }
    }
    if (2 * blurs.size() > windows.size()) {
        traits.blur_px = quantile(blurs, 0.5);
    }
    return traits;
}

void fields(JsonArchive& json, PictureTraits& traits) {
    json.field("white", traits.white)
        .field("black", traits.black)
        .field("noise", traits.noise)
        .optional("blur_px", traits.blur_px)
        .optional("light_gradient_per_mm", traits.light_gradient_per_mm);
}

}  // namespace lensproof::calibration
