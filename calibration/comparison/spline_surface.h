// calibration/comparison/spline_surface.h — a picture between its pixels.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/base/vec.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// The interpolating cubic B-spline of one channel, mirrored about the outermost pixels' centres (Unser, Aldroubi and
/// Eden 1993): exact at the pixels, and of a wave of 8 px per period off by at most 0.2 % of its amplitude between
/// them.
class SplineSurface {
  public:
    SplineSurface(const formats::Image& image, int channel, int threads);

    /// Whether the place, in px, lies among the pixels' centres.
    [[nodiscard]] bool covers(const Vec2d& place) const {
        return place.x >= 0.0 && place.y >= 0.0 && place.x <= width_ - 1 && place.y <= height_ - 1;
    }

    /// The value at a place that it covers.
    [[nodiscard]] double at(const Vec2d& place) const {
        const int left = static_cast<int>(place.x);
        const int top = static_cast<int>(place.y);
        const std::array<double, 4> across = weights(place.x - left);
        const std::array<double, 4> down = weights(place.y - top);
        // Coefficients have a mirrored margin of one on the near side and two on the far side.
        const float* row = coefficients_.data() + static_cast<std::size_t>(top) * stride_ + left;
        double sum = 0.0;
        for (const double weight : down) {
            sum += weight * (across[0] * static_cast<double>(row[0]) + across[1] * static_cast<double>(row[1]) +
                             across[2] * static_cast<double>(row[2]) + across[3] * static_cast<double>(row[3]));
            row += stride_;
        }
        return sum;
    }

  private:
    /// Of the cubic B-splines at -1, 0, 1 and 2, at `t` from 0 to 1.
    static std::array<double, 4> weights(double t) {
        const double s = 1.0 - t;
        return {s * s * s / 6.0, 2.0 / 3.0 - 0.5 * t * t * (2.0 - t), 2.0 / 3.0 - 0.5 * s * s * (2.0 - s),
                t * t * t / 6.0};
    }

    int width_;
    int height_;
    std::size_t stride_;
    std::vector<float> coefficients_;
};

}  // namespace lensproof::calibration
