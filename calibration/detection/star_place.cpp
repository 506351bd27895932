#include "calibration/detection/star_place.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/order_statistics.h"

namespace lensproof::calibration {
namespace {

constexpr double kStandsOut = 5.0;           // standard deviations of the mean of nine pixels
constexpr double kNarrowestWeight_px = 1.0;  // a narrower weight meets too few pixels of a small star to be even
constexpr double kUsual_px = 1.5;
constexpr double kCut = 4.0;  // of the weight's width: what is farther counts less than 4e-4
constexpr int kStarRounds = 50;
constexpr double kStill_px = 1e-4;

struct StarWindow {
    int left = 0;
    int top = 0;
    int right = 0;   // the last column,
    int bottom = 0;  // the last row

    /// The pixels within `reach` of `middle`, which is finite, along either axis.
    StarWindow(const formats::Image& image, const Vec2d& middle, double reach) {
        const auto inside = [](double at, int pixels) { return static_cast<int>(std::clamp(at, -1.0, 1.0 * pixels)); };
        left = std::max(0, inside(std::ceil(middle.x - reach), image.width));
        top = std::max(0, inside(std::ceil(middle.y - reach), image.height));
        right = std::min(image.width - 1, inside(std::floor(middle.x + reach), image.width));
        bottom = std::min(image.height - 1, inside(std::floor(middle.y + reach), image.height));
    }

    template <class Visit>
    void each(const Visit& visit) const {
        for (int y = top; y <= bottom; ++y) {
            for (int x = left; x <= right; ++x) {
                visit(x, y);
            }
        }
    }
};

struct Sky {
    double light = 0.0;
    double noise = 0.0;
};

// Stars take up little of it.
std::optional<Sky> sky_around(const formats::Image& image, int channel, const StarWindow& window) {
    std::vector<double> lights;
    window.each([&](int x, int y) { lights.push_back(image.at(x, y, channel)); });
    if (lights.empty() || !std::ranges::all_of(lights, [](double light) { return std::isfinite(light); })) {
        return std::nullopt;
    }
    Sky sky{.light = median(lights)};
    for (double& light : lights) {
        light = std::abs(light - sky.light);
    }
    sky.noise = kSigmaPerMedian * median(lights);
    return sky;
}

// The middle of the brightest 3 × 3 pixels.
std::optional<Vec2d> brightest(const formats::Image& image, int channel, const Vec2d& near, double reach,
                               const Sky& sky) {
    StarWindow inside(image, near, reach);
    inside.left = std::max(inside.left, 1);
    inside.top = std::max(inside.top, 1);
    inside.right = std::min(inside.right, image.width - 2);
    inside.bottom = std::min(inside.bottom, image.height - 2);
    double most = sky.light + kStandsOut * sky.noise / 3.0;
    std::optional<Vec2d> place;
    inside.each([&](int x, int y) {
        double sum = 0.0;
        for (int k = 0; k < 9; ++k) {
            sum += image.at(x + k % 3 - 1, y + k / 3 - 1, channel);
        }
        if (sum / 9.0 > most && std::hypot(x - near.x, y - near.y) <= reach) {
            most = sum / 9.0;
            place = Vec2d{1.0 * x, 1.0 * y};
        }
    });
    return place;
}

struct Moments {
    double light = 0.0;
    Vec2d off;              // the centroid, from the middle
    double variance = 0.0;  // along an axis
    Vec2d squares;          // of what a pixel does to the sums of the centroid
};

Moments weighted(const formats::Image& image, int channel, const Vec2d& at, double width, const Sky& sky) {
    Moments sums;
    StarWindow(image, at, kCut * width).each([&](int x, int y) {
        const Vec2d d{x - at.x, y - at.y};
        const double weight = std::exp(-0.5 * dot(d, d) / (width * width));
        const double light = weight * (image.at(x, y, channel) - sky.light);
        sums.light += light;
        sums.off = sums.off + light * d;
        sums.variance += 0.5 * light * dot(d, d);
        sums.squares = {sums.squares.x + weight * weight * d.x * d.x, sums.squares.y + weight * weight * d.y * d.y};
    });
    sums.off = (1.0 / sums.light) * sums.off;
    sums.variance /= sums.light;
    return sums;
}

}  // namespace

std::optional<StarPlace> locate_star(const formats::Image& image, int channel, const Vec2d& near_px, double reach_px) {
    if (!std::isfinite(near_px.x + near_px.y)) {
        return std::nullopt;
    }
    const auto sky = sky_around(image, channel, StarWindow(image, near_px, 2.0 * reach_px));
    auto at = sky ? brightest(image, channel, near_px, reach_px, *sky) : std::nullopt;
    double width = kUsual_px;
    for (int round = 0; round < kStarRounds && at; ++round) {
        const Moments sums = weighted(image, channel, *at, width, *sky);
        if (!(sums.light > 0.0)) {
            return std::nullopt;
        }
        // The spot's variance v under the weight's w: 1/v + 1/w is seen as the inverse, and w / (v + w) of an offset.
        const double inverse = 1.0 / sums.variance - 1.0 / (width * width);
        const double widest = reach_px / kCut;
        const double own = inverse > 1.0 / (widest * widest) ? 1.0 / std::sqrt(inverse) : widest;
        const double gain = 1.0 + own * own / (width * width);
        const Vec2d step = gain * sums.off;
        const double next = std::max(own, kNarrowestWeight_px);
        if (length(step) < kStill_px && std::abs(next - width) < kStill_px) {
            const Vec2d error{std::sqrt(sums.squares.x), std::sqrt(sums.squares.y)};
            return StarPlace{.centre_px = *at, .standard_error_px = (gain * sky->noise / sums.light) * error};
        }
        at = *at + step;
        width = next;
        if (length(*at - near_px) > reach_px) {
            return std::nullopt;
        }
    }
    return std::nullopt;
}

}  // namespace lensproof::calibration
