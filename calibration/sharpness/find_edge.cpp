#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/sharpness/slanted_edge.h"

namespace lensproof::calibration {
namespace {

constexpr double kLeastGradient = 0.3;  // of the steepest; noise is flatter
constexpr double kWidestHalfWidth_px = 32.0;

struct GradientPixel {
    double x = 0.0, y = 0.0;    // its place
    double gx = 0.0, gy = 0.0;  // differences over three rows or columns (Prewitt), which quieten noise
};

std::vector<GradientPixel> gradients(const formats::Image& image, int channel, const PixelRectangle& r) {
    std::vector<GradientPixel> list;
    for (int y = r.y + 1; y < r.y + r.height - 1; ++y) {
        for (int x = r.x + 1; x < r.x + r.width - 1; ++x) {
            GradientPixel pixel{static_cast<double>(x), static_cast<double>(y), 0.0, 0.0};
            for (int k = -1; k <= 1; ++k) {
                pixel.gx += image.at(x + 1, y + k, channel) - image.at(x - 1, y + k, channel);
                pixel.gy += image.at(x + k, y + 1, channel) - image.at(x + k, y - 1, channel);
            }
            if (std::isfinite(pixel.gx + pixel.gy)) {
                list.push_back(pixel);
            }
        }
    }
    return list;
}

// How far one may go from `at` along ±`direction` and stay inside.
double reach(const PixelRectangle& r, const Vec2d& at, const Vec2d& direction) {
    const auto axis = [](double position, double low, double high, double step) {
        return step == 0.0 ? 1e9 : std::min(position - low, high - position) / std::abs(step);
    };
    return std::min(axis(at.x, r.x - 0.5, r.x + r.width - 0.5, direction.x),
                    axis(at.y, r.y - 0.5, r.y + r.height - 0.5, direction.y));
}

}  // namespace

std::variant<EdgeRegion, EdgeRefusal> find_edge(const formats::Image& image, int channel,
                                                const PixelRectangle& rectangle) {
    if (rectangle.x < 0 || rectangle.y < 0 || rectangle.width < 3 || rectangle.height < 3 ||
        rectangle.width > image.width - rectangle.x || rectangle.height > image.height - rectangle.y) {
        return EdgeRefusal{"reaches beyond the picture, or is too small"};
    }
    std::vector<GradientPixel> list = gradients(image, channel, rectangle);
    double steepest = 0.0;
    for (const GradientPixel& p : list) {
        steepest = std::max(steepest, std::hypot(p.gx, p.gy));
    }
    std::erase_if(list, [&](const GradientPixel& p) { return std::hypot(p.gx, p.gy) < kLeastGradient * steepest; });
    if (!(steepest > 0.0) || list.size() < 10) {
        return EdgeRefusal{"has no edge"};
    }
    // A line by least squares across itself, its pixels weighed by their gradient.
    double weight = 0.0;
    Vec2d middle;
    for (const GradientPixel& p : list) {
        const double w = std::hypot(p.gx, p.gy);
        weight += w;
        middle = {middle.x + w * p.x, middle.y + w * p.y};
    }
    middle = {middle.x / weight, middle.y / weight};
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (const GradientPixel& p : list) {
        const double w = std::hypot(p.gx, p.gy);
        xx += w * (p.x - middle.x) * (p.x - middle.x);
        xy += w * (p.x - middle.x) * (p.y - middle.y);
        yy += w * (p.y - middle.y) * (p.y - middle.y);
    }
    const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
    const Vec2d along{std::cos(angle), std::sin(angle)};
    const double across_variance = xx * along.y * along.y - 2.0 * xy * along.x * along.y + yy * along.x * along.x;
    const double along_variance = xx * along.x * along.x + 2.0 * xy * along.x * along.y + yy * along.y * along.y;
    if (across_variance > 0.04 * along_variance) {
        return EdgeRefusal{"has no edge longer than five times its blur"};
    }
    // The rectangle's middle along the edge; the width that fits over some 90 % of the edge.
    const Vec2d normal{-along.y, along.x};
    const double half_width_there = std::min(reach(rectangle, middle, normal), kWidestHalfWidth_px);
    const double whole = reach(rectangle, middle, along);
    EdgeRegion best;
    for (double fraction = 0.5; fraction <= 1.0; fraction += 0.02) {
        const double half_length = fraction * whole;
        double half_width = half_width_there;
        for (const double end : {-half_length, half_length}) {
            half_width =
                std::min(half_width, reach(rectangle, {middle.x + end * along.x, middle.y + end * along.y}, normal));
        }
        // Length lowers the noise; width beyond a dozen pixels adds little.
        if (half_length * std::min(half_width, 12.0) > best.half_length_px * std::min(best.half_width_px, 12.0)) {
            best = {middle, along, half_length, half_width};
        }
    }
    return best;
}

}  // namespace lensproof::calibration
