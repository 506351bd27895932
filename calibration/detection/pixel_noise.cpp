#include "calibration/detection/pixel_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/base/order_statistics.h"

namespace lensproof::calibration {
namespace {

constexpr int kFarthest_px = 40;         // looked at around a point; more pixels tell no more
constexpr double kMedianOfAbs = 0.6745;  // of a normal distribution, in standard deviations
constexpr double kMaskNorm = 6.0;        // root of the sum of the mask's squares
constexpr std::size_t kFewestSteps = 25;
constexpr double kMostStep = 7.0;          // of the noise: five standard deviations of a difference; more is an edge
constexpr double kIntegerFullScale = 1.0;  // integer formats end there

struct Region {
    int x0;
    int x1;
    int y0;
    int y1;
};

Region around(const Vec2d& point, int reach) {
    const int x = static_cast<int>(std::lround(point.x));
    const int y = static_cast<int>(std::lround(point.y));
    return {.x0 = x - reach, .x1 = x + reach, .y0 = y - reach, .y1 = y + reach};
}

// The median absolute response in a region, of pixels whose neighbours differ by less than `most_step`; none where
// there are too few.
std::optional<double> response(const formats::Image& image, int channel, const Region& region, double most_step) {
    std::vector<double> responses;
    for (int y = std::max(1, region.y0); y <= std::min(image.height - 2, region.y1); ++y) {
        for (int x = std::max(1, region.x0); x <= std::min(image.width - 2, region.x1); ++x) {
            const auto at = [&](int dx, int dy) { return static_cast<double>(image.at(x + dx, y + dy, channel)); };
            const double laplacian = at(-1, -1) + at(1, -1) + at(-1, 1) + at(1, 1) -
                                     2.0 * (at(0, -1) + at(-1, 0) + at(1, 0) + at(0, 1)) + 4.0 * at(0, 0);
            const double step = std::hypot(at(1, 0) - at(-1, 0), at(0, 1) - at(0, -1));
            if (std::isfinite(laplacian) && at(0, 0) < kIntegerFullScale && step <= most_step) {
                responses.push_back(std::abs(laplacian));
            }
        }
    }
    return responses.size() < kFewestSteps ? std::nullopt : std::optional(median(responses));
}

// Were the noise normal.
double noise_of(double median_response) {
    return median_response / (kMaskNorm * kMedianOfAbs);
}

double noise_between(const formats::Image& image, int channel, const ChartPoints& points, double most_step) {
    std::vector<double> responses;
    for (std::size_t i = 0; i < points.image_px.size(); ++i) {
        const auto one = points.found[i] ? response(image, channel,
                                                    around(points.image_px[i], neighbourhood_px(points, i)), most_step)
                                         : std::nullopt;
        if (one) {
            responses.push_back(*one);
        }
    }
    return responses.empty() ? 0.0 : noise_of(median(responses));
}

}  // namespace

int neighbourhood_px(const ChartPoints& points, std::size_t i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < points.image_px.size(); ++j) {
        if (j != i && points.found[j]) {
            nearest = std::min(nearest, std::hypot(points.image_px[j].x - points.image_px[i].x,
                                                   points.image_px[j].y - points.image_px[i].y));
        }
    }
    return static_cast<int>(std::min<double>(kFarthest_px, 0.5 * nearest));
}

double pixel_noise(const formats::Image& image, int channel, const ChartPoints& points) {
    const double first = noise_between(image, channel, points, std::numeric_limits<double>::infinity());
    return noise_between(image, channel, points, kMostStep * first);
}

double pixel_noise(const formats::Image& image, int channel) {
    const Region whole{.x0 = 0, .x1 = image.width, .y0 = 0, .y1 = image.height};
    const auto among = [&](double most_step) {
        const auto found = response(image, channel, whole, most_step);
        return found ? noise_of(*found) : 0.0;
    };
    return among(kMostStep * among(std::numeric_limits<double>::infinity()));
}

}  // namespace lensproof::calibration
