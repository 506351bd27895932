#include "calibration/picture/picture_quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/order_statistics.h"

namespace lensproof::calibration {
namespace {

constexpr double kEdgeWidth = 2.563;  // from 10 % to 90 % of a Gaussian's edge, in its standard deviations
constexpr double kWidestEdge_fraction = 0.25;
constexpr float kNearFullScale = 0.998F;     // 8-bit 255, and half a step below it in the light
constexpr double kMostClipped = 0.3;         // of a picture
constexpr double kDarkest = 0.02;            // of full scale, what the brightest parts should reach
constexpr double kLeastSlope_per_px = 0.06;  // steepest slope over contrast: a Gaussian edge of σ = 6.6 px
constexpr double kSteepestPart = 0.999;      // of the pixels are less steep

}  // namespace

std::string too_blurred(const PictureTraits& traits, const ChartPoints& points, const scene::Chart& chart) {
    const scene::ChartTraits known = scene::traits(chart);
    if (known.white == scene::WhiteCells::none || !traits.blur_px) {
        return "";
    }
    const auto columns = static_cast<std::size_t>(known.points.columns);
    std::vector<double> steps;
    for (std::size_t i = 1; i < points.image_px.size(); ++i) {
        if (i % columns != 0 && points.found[i - 1] && points.found[i]) {
            steps.push_back(std::hypot(points.image_px[i].x - points.image_px[i - 1].x,
                                       points.image_px[i].y - points.image_px[i - 1].y));
        }
    }
    const double width_px = kEdgeWidth * *traits.blur_px;
    const double fraction = steps.empty() ? 0.0 : width_px / median(steps);
    if (fraction <= kWidestEdge_fraction) {
        return "";
    }
    return fmt::format("blurred: edges are {:.1f} px wide, {:.0f} % of the distance between the chart's points",
                       width_px, 100.0 * fraction);
}

bool is_white_clipped(const PictureTraits& traits) {
    return traits.white >= kNearFullScale;
}

std::string visible_fault(const formats::Image& image, int channel) {
    std::vector<float> tones;
    std::vector<float> slopes;
    for (int y = 0; y + 2 < image.height; ++y) {
        for (int x = 0; x + 2 < image.width; ++x) {
            const float dx = image.at(x + 2, y + 1, channel) - image.at(x, y + 1, channel);
            const float dy = image.at(x + 1, y + 2, channel) - image.at(x + 1, y, channel);
            if (std::isfinite(dx) && std::isfinite(dy)) {
                tones.push_back(image.at(x + 1, y + 1, channel));
                slopes.push_back(0.5F * std::hypot(dx, dy));
            }
        }
    }
    if (tones.empty()) {
        return "";
    }
    const double clipped =
        static_cast<double>(std::ranges::count_if(tones, [](float v) { return v >= kNearFullScale; })) /
        static_cast<double>(tones.size());
    const double bright = quantile(tones, 0.995);
    const double contrast = bright - quantile(tones, 0.005);
    if (clipped > kMostClipped) {
        return fmt::format("over-exposed: {:.0f} % of the picture is at full scale", 100.0 * clipped);
    }
    if (bright < kDarkest) {
        return fmt::format("under-exposed: the brightest parts reach {:.2g} % of full scale", 100.0 * bright);
    }
    const double slope = quantile(slopes, kSteepestPart);
    if (contrast > 0.0 && slope < kLeastSlope_per_px * contrast) {
        return fmt::format("blurred: no edge in it is steeper than {:.1f} % of the contrast a pixel",
                           100.0 * slope / contrast);
    }
    return "";
}

}  // namespace lensproof::calibration
