#include "calibration/comparison/radial_difference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "calibration/comparison/colour_planes.h"

namespace lensproof::calibration {

namespace {

constexpr int kRings = 20;
constexpr int kSectors = 16;
constexpr int kFewestSectors = 4;

// Luminance, R, G, B of the first, of the second, colour difference, pixels.
constexpr std::size_t kSums = 10;
using Sums = std::array<double, kSums>;

Sums operator-(Sums sums, const Sums& others) {
    for (std::size_t i = 0; i < kSums; ++i) {
        sums[i] -= others[i];
    }
    return sums;
}

void add_pixel(Sums& sums, const Vec3d& one, const Vec3d& other, double difference) {
    const std::array<double, kSums> terms{luminance(one), one.x,   one.y,   one.z,      luminance(other),
                                          other.x,        other.y, other.z, difference, 1.0};
    for (std::size_t i = 0; i < kSums; ++i) {
        sums[i] += terms[i];
    }
}

double ratio_ev(const Sums& sums, std::size_t above, std::size_t below) {
    return std::log2(sums[above + 4] / sums[below + 4] / (sums[above] / sums[below]));
}

double statistic(const std::string& name, const Sums& sums) {
    if (name == "brightness_ev") {
        return std::log2(sums[4] / sums[0]);
    }
    if (name == "red_over_green_ev") {
        return ratio_ev(sums, 1, 2);
    }
    if (name == "blue_over_green_ev") {
        return ratio_ev(sums, 3, 2);
    }
    return sums[8] / sums[9];
}

/// Of a ring's sectors: the value of all, and its band by leaving each out.
std::optional<Banded> banded(const std::string& name, const std::vector<Sums>& sectors) {
    Sums total{};
    int count = 0;
    for (const Sums& sector : sectors) {
        for (std::size_t i = 0; i < kSums; ++i) {
            total[i] += sector[i];
        }
        count += sector[kSums - 1] > 0.0 ? 1 : 0;
    }
    const double value = statistic(name, total);
    if (count < kFewestSectors || !std::isfinite(value)) {
        return std::nullopt;
    }
    double squares = 0.0;
    for (const Sums& sector : sectors) {
        if (sector[kSums - 1] > 0.0) {
            const double without = statistic(name, total - sector);
            squares += std::isfinite(without) ? (without - value) * (without - value) : 0.0;
        }
    }
    const double half = k95 * std::sqrt(squares * (count - 1) / count);
    return Banded{.value = value, .lower_95 = value - half, .upper_95 = value + half};
}

}  // namespace

std::map<std::string, Curve> radial_differences(const formats::Image& a, const formats::Image& b,
                                                const formats::Image& colour_difference, const Overlap& overlap) {
    std::vector<std::vector<Sums>> rings(kRings, std::vector<Sums>(kSectors, Sums{}));
    const double middle_x = 0.5 * (a.width - 1);
    const double middle_y = 0.5 * (a.height - 1);
    const double half_diagonal = 0.5 * std::hypot(a.width, a.height);
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            const auto pixel =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(a.width) + static_cast<std::size_t>(x);
            if (overlap[pixel] == 0) {
                continue;
            }
            const double height = std::hypot(x - middle_x, y - middle_y) / half_diagonal;
            const double turn = std::atan2(y - middle_y, x - middle_x) / (2.0 * std::numbers::pi) + 0.5;
            const int ring = std::min(kRings - 1, static_cast<int>(height * kRings));
            const int sector = std::min(kSectors - 1, static_cast<int>(turn * kSectors));
            add_pixel(rings[static_cast<std::size_t>(ring)][static_cast<std::size_t>(sector)], rgb_at(a, pixel),
                      rgb_at(b, pixel), static_cast<double>(colour_difference.pixels[pixel]));
        }
    }
    std::vector<std::string> names{"brightness_ev", "ciede2000"};
    if (a.channel_count() == 3) {
        names.insert(names.end(), {"red_over_green_ev", "blue_over_green_ev"});
    }
    std::map<std::string, Curve> curves;
    for (const std::string& name : names) {
        Curve& curve = curves[name];
        for (int ring = 0; ring < kRings; ++ring) {
            if (const auto sample = banded(name, rings[static_cast<std::size_t>(ring)])) {
                const double height = (ring + 0.5) / kRings;
                append(curve, height, *sample);
                curve.covered_image_height = height;
            }
        }
    }
    return curves;
}

}  // namespace lensproof::calibration
