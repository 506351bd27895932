#include "engine/analysis/light_raster.h"

#include <algorithm>
#include <cmath>

namespace lensproof::analysis {

namespace {

// Below it a triangle's light over its area loses more digits than a pixel's energy may: pixels².
constexpr double kSliver = 1e-4;

}  // namespace

LightRaster::LightRaster(int width, int height, double pitch_mm)
    : width_(width),
      height_(height),
      pitch_(pitch_mm),
      differences_(static_cast<std::size_t>(width + 2) * static_cast<std::size_t>(height)) {}

double LightRaster::half_diagonal_mm() const {
    return 0.5 * pitch_ * std::hypot(width_, height_);
}

void LightRaster::clear() {
    std::ranges::fill(differences_, 0.0);
}

void LightRaster::add(const LightRaster& other) {
    for (std::size_t i = 0; i < differences_.size(); ++i) {
        differences_[i] += other.differences_[i];
    }
}

std::vector<double> LightRaster::pixels() const {
    std::vector<double> pixels;
    pixels.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    for (int v = 0; v < height_; ++v) {
        const double* row = &differences_[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_ + 2)];
        double sum = 0.0;
        for (int u = 0; u < width_; ++u) {
            sum += row[u];
            pixels.push_back(std::max(0.0, sum));  // of dark pixels rounding is left
        }
    }
    return pixels;
}

void LightRaster::add(const std::array<Vec2d, 3>& corners, double energy) {
    std::array<Vec2d, 3> at;  // (0, 0) is the first pixel's outer corner
    Vec2d low{1e300, 1e300};
    Vec2d high{-1e300, -1e300};
    for (std::size_t i = 0; i < 3; ++i) {
        at[i] = {0.5 * width_ - corners[i].x / pitch_, 0.5 * height_ + corners[i].y / pitch_};
        low = {std::min(low.x, at[i].x), std::min(low.y, at[i].y)};
        high = {std::max(high.x, at[i].x), std::max(high.y, at[i].y)};
    }
    if (!(low.x < width_ && low.y < height_ && high.x > 0.0 && high.y > 0.0)) {
        return;
    }
    const double area = 0.5 * cross(at[1] - at[0], at[2] - at[0]);
    if (std::abs(area) < kSliver) {
        add_sliver(at, energy);
        return;
    }
    // Where the map turns the triangle over, its area's sign and that of what its sides enclose are the same.
    const double density = energy / area;
    add_side(at[0], at[1], density);
    add_side(at[1], at[2], density);
    add_side(at[2], at[0], density);
}

/// The pixels to the right of a side gain `density` over the heights that it passes, those that it crosses in part.
void LightRaster::add_side(Vec2d from, Vec2d to, double density) {
    double sign = -density;
    if (from.y > to.y) {
        std::swap(from, to);
        sign = density;
    }
    if (!(to.y > 0.0) || !(from.y < height_) || from.y == to.y) {
        return;
    }
    const double slope = (to.x - from.x) / (to.y - from.y);
    double y = std::max(from.y, 0.0);
    const double end = std::min(to.y, static_cast<double>(height_));
    double x = from.x + (y - from.y) * slope;
    for (int row = static_cast<int>(y); y < end; ++row) {
        double* differences = &differences_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_ + 2)];
        const double next_y = std::min(row + 1.0, end);
        const double next_x = next_y == to.y ? to.x : x + (next_y - y) * slope;
        const double height = sign * (next_y - y);
        double left = std::min(x, next_x);
        double right = std::max(x, next_x);
        y = next_y;
        x = next_x;
        if (left >= width_) {
            continue;
        }
        if (right <= 0.0) {
            differences[0] += height;
            continue;
        }
        int first = static_cast<int>(left);
        if (left >= 0.0 && right <= first + 1.0) {
            // Of what stands right of the middle, a part of this pixel, and all of the next.
            const double inside = 1.0 - (0.5 * (left + right) - first);
            differences[first] += height * inside;
            differences[first + 1] += height * (1.0 - inside);
            continue;
        }
        const double by_width = height / (right - left);
        if (left < 0.0) {
            differences[0] += -left * by_width;
            left = 0.0;
            first = 0;
        }
        right = std::min(right, static_cast<double>(width_));
        for (int u = first; u < right; ++u) {
            const double a = std::max(left, static_cast<double>(u));
            const double b = std::min(right, u + 1.0);
            const double passed = (b - a) * by_width;
            const double inside = 1.0 - (0.5 * (a + b) - u);
            differences[u] += passed * inside;
            differences[u + 1] += passed * (1.0 - inside);
        }
    }
}

/// Along its longest side, as dense as the triangle is wide there.
void LightRaster::add_sliver(const std::array<Vec2d, 3>& corners, double energy) {
    std::size_t longest = 0;
    double length_squared = -1.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec2d side = corners[(i + 1) % 3] - corners[i];
        if (dot(side, side) > length_squared) {
            length_squared = dot(side, side);
            longest = i;
        }
    }
    const Vec2d from = corners[longest];
    const Vec2d side = corners[(longest + 1) % 3] - from;
    const double apex = length_squared > 0.0
                            ? std::clamp(dot(corners[(longest + 2) % 3] - from, side) / length_squared, 0.0, 1.0)
                            : 0.5;
    const auto part_before = [&](double t) {
        return t <= apex ? (apex > 0.0 ? t * t / apex : 0.0) : 1.0 - (1.0 - t) * (1.0 - t) / (1.0 - apex);
    };
    const int pieces = 1 + static_cast<int>(std::min(8.0 * std::sqrt(length_squared), 1e5));
    double before = 0.0;
    for (int i = 0; i < pieces; ++i) {
        const double upto = i + 1 == pieces ? 1.0 : part_before((i + 1.0) / pieces);
        add_point(from + ((i + 0.5) / pieces) * side, energy * (upto - before));
        before = upto;
    }
}

void LightRaster::add_point(Vec2d at, double energy) {
    if (at.x >= 0.0 && at.y >= 0.0 && at.x < width_ && at.y < height_) {
        double* pixel = &differences_[static_cast<std::size_t>(at.y) * static_cast<std::size_t>(width_ + 2) +
                                      static_cast<std::size_t>(at.x)];
        pixel[0] += energy;
        pixel[1] -= energy;
    }
}

}  // namespace lensproof::analysis
