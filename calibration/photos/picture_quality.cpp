#include "calibration/photos/picture_quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace lensproof {
namespace {

constexpr int kProfileSamples = 61;
constexpr double kWidestEdge_share = 0.25;
constexpr float kFullScale = 0.998F;         // 8-bit 255, and half a step below it in the light
constexpr double kMostClipped = 0.3;         // of a picture
constexpr double kDarkest = 0.02;            // of full scale, what the brightest parts should reach
constexpr double kLeastSlope_per_px = 0.06;  // steepest slope over contrast: a Gaussian edge of σ = 6.6 px
constexpr double kSteepestPart = 0.999;      // of the pixels are less steep

std::optional<double> bilinear(const Image& image, int channel, const Vec2d& p) {
    const int x = static_cast<int>(std::floor(p.x));
    const int y = static_cast<int>(std::floor(p.y));
    if (!(p.x >= 0.0 && p.y >= 0.0) || x + 1 >= image.width || y + 1 >= image.height) {
        return std::nullopt;
    }
    const double u = p.x - x;
    const double v = p.y - y;
    const auto at = [&](int i, int j) { return static_cast<double>(image.at(x + i, y + j, channel)); };
    return std::lerp(std::lerp(at(0, 0), at(1, 0), u), std::lerp(at(0, 1), at(1, 1), u), v);
}

/// From the dark side to the bright one.
struct EdgeProfile {
    double width_px = 0.0;
    bool clipped = false;
};

std::optional<EdgeProfile> edge_between(const Image& image, int channel, const Vec2d& from, const Vec2d& to) {
    std::array<double, kProfileSamples> tone{};
    for (int i = 0; i < kProfileSamples; ++i) {
        const double t = i / (kProfileSamples - 1.0);
        const auto value = bilinear(image, channel, {std::lerp(from.x, to.x, t), std::lerp(from.y, to.y, t)});
        if (!value || !std::isfinite(*value)) {
            return std::nullopt;
        }
        tone[static_cast<std::size_t>(i)] = *value;
    }
    constexpr int kEnd = kProfileSamples / 8;
    double first = 0.0;
    double last = 0.0;
    for (std::size_t i = 0; i < kEnd; ++i) {
        first += tone[i] / kEnd;
        last += tone[kProfileSamples - 1 - i] / kEnd;
    }
    if (!(std::abs(last - first) > 0.01 * std::max(std::abs(first), std::abs(last)))) {
        return std::nullopt;
    }
    const auto passed = [&](double share) {
        const double level = std::lerp(first, last, share);
        const auto* const place =
            std::ranges::find_if(tone, [&](double value) { return last > first ? value >= level : value <= level; });
        return static_cast<double>(place - tone.begin());
    };
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    return EdgeProfile{.width_px = (passed(0.9) - passed(0.1)) * length / (kProfileSamples - 1),
                       .clipped = std::max(first, last) >= kFullScale};
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Across the edge that joins two corners of a board; or from a disc to the white between it and the next.
std::optional<EdgeProfile> edge_at(const Image& image, int channel, const Vec2d& a, const Vec2d& b, bool discs) {
    const Vec2d along{b.x - a.x, b.y - a.y};
    const Vec2d middle{0.5 * (a.x + b.x), 0.5 * (a.y + b.y)};
    if (discs) {
        return edge_between(image, channel, a, middle);
    }
    constexpr double kReach = 0.4;  // of the edge's length, to each side
    return edge_between(image, channel, {middle.x + kReach * along.y, middle.y - kReach * along.x},
                        {middle.x - kReach * along.y, middle.y + kReach * along.x});
}

}  // namespace

ChartQuality chart_quality(const Image& image, int channel, const ChartPoints& points, const Chart& chart) {
    const bool discs = std::holds_alternative<DiscGrid>(chart.pattern);
    if (!discs && !std::holds_alternative<Checkerboard>(chart.pattern)) {
        return {};
    }
    const int columns = feature_grid(chart).columns;
    std::vector<double> widths;
    std::vector<double> shares;
    int clipped = 0;
    for (std::size_t i = 1; i < points.image_px.size(); ++i) {
        if (i % static_cast<std::size_t>(columns) == 0 || !points.found[i - 1] || !points.found[i]) {
            continue;
        }
        const Vec2d& a = points.image_px[i - 1];
        const Vec2d& b = points.image_px[i];
        if (const auto edge = edge_at(image, channel, a, b, discs)) {
            widths.push_back(edge->width_px);
            shares.push_back(edge->width_px / std::hypot(b.x - a.x, b.y - a.y));
            clipped += edge->clipped ? 1 : 0;
        }
    }
    if (widths.empty()) {
        return {};
    }
    return {.edge_width_px = median(widths),
            .edge_width_share = median(shares),
            .clipped_white_share = static_cast<double>(clipped) / static_cast<double>(widths.size())};
}

std::string too_blurred(const ChartQuality& quality) {
    if (quality.edge_width_share <= kWidestEdge_share) {
        return "";
    }
    return fmt::format("blurred: edges are {:.1f} px wide, {:.0f} % of the distance between the chart's points",
                       quality.edge_width_px, 100.0 * quality.edge_width_share);
}

std::string visible_fault(const Image& image, int channel) {
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
    const auto quantile = [](std::vector<float>& values, double share) {
        const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
        std::nth_element(values.begin(), place, values.end());
        return static_cast<double>(*place);
    };
    const double clipped = static_cast<double>(std::ranges::count_if(tones, [](float v) { return v >= kFullScale; })) /
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

}  // namespace lensproof
