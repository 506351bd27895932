#include "calibration/comparison/ciede2000.h"

#include <algorithm>
#include <cmath>

#include "calibration/comparison/colour_planes.h"
#include "calibration/comparison/stripes.h"
#include "engine/base/angle.h"
#include "engine/spectral/colour_matching.h"

namespace lensproof::calibration {

namespace {

/// c⁷ / (c⁷ + 25⁷), its root: how strong a colour is, 0 to 1.
double strength(double chroma) {
    const double seventh = std::pow(chroma, 7.0);
    return std::sqrt(seventh / (seventh + 6103515625.0));
}

/// 0 to 360; 0 where there is no hue.
double hue_deg(double a, double b) {
    if (a == 0.0 && b == 0.0) {
        return 0.0;
    }
    const double hue = degrees(std::atan2(b, a));
    return hue < 0.0 ? hue + 360.0 : hue;
}

double cos_deg(double angle_deg) {
    return std::cos(radians(angle_deg));
}

struct Hues {
    double difference_deg = 0.0;  // of the second from the first, -180 to 180
    double mean_deg = 0.0;
};

Hues compared(double first, double second, bool both_have_one) {
    if (!both_have_one) {
        return {.difference_deg = 0.0, .mean_deg = first + second};
    }
    const double difference = second - first;
    if (std::abs(difference) <= 180.0) {
        return {.difference_deg = difference, .mean_deg = 0.5 * (first + second)};
    }
    return {.difference_deg = difference > 0.0 ? difference - 360.0 : difference + 360.0,
            .mean_deg = 0.5 * (first + second + (first + second < 360.0 ? 360.0 : -360.0))};
}

Vec3d lab_of(const Vec3d& linear_rgb) {
    const auto shown = [](double value) { return std::clamp(value, 0.0, 1.0); };
    return spectral::cielab(xyz_of({shown(linear_rgb.x), shown(linear_rgb.y), shown(linear_rgb.z)}), kWhite);
}

}  // namespace

double ciede2000(const Vec3d& lab_a, const Vec3d& lab_b) {
    // More red and green for greys: eq. 2 to 7.
    const double stretch =
        1.0 + 0.5 * (1.0 - strength(0.5 * (std::hypot(lab_a.y, lab_a.z) + std::hypot(lab_b.y, lab_b.z))));
    const double chroma_a = std::hypot(stretch * lab_a.y, lab_a.z);
    const double chroma_b = std::hypot(stretch * lab_b.y, lab_b.z);
    // Eq. 8 to 14.
    const auto [hue_step, hue] =
        compared(hue_deg(stretch * lab_a.y, lab_a.z), hue_deg(stretch * lab_b.y, lab_b.z), chroma_a * chroma_b > 0.0);
    const double d_hue = 2.0 * std::sqrt(chroma_a * chroma_b) * std::sin(radians(0.5 * hue_step));
    const double chroma = 0.5 * (chroma_a + chroma_b);
    const double from_middle = std::pow(0.5 * (lab_a.x + lab_b.x) - 50.0, 2.0);
    // Eq. 15 to 21.
    const double t = 1.0 - 0.17 * cos_deg(hue - 30.0) + 0.24 * cos_deg(2.0 * hue) + 0.32 * cos_deg(3.0 * hue + 6.0) -
                     0.20 * cos_deg(4.0 * hue - 63.0);
    const double rotation =
        -2.0 * strength(chroma) * std::sin(radians(60.0 * std::exp(-std::pow((hue - 275.0) / 25.0, 2.0))));
    const double l = (lab_b.x - lab_a.x) / (1.0 + 0.015 * from_middle / std::sqrt(20.0 + from_middle));
    const double c = (chroma_b - chroma_a) / (1.0 + 0.045 * chroma);
    const double h = d_hue / (1.0 + 0.015 * chroma * t);
    return std::sqrt(std::max(0.0, l * l + c * c + h * h + rotation * c * h));
}

formats::Image ciede2000_map(const formats::Image& a, const formats::Image& b, int threads) {
    formats::Image map = formats::make_image(a.width, a.height, {"ciede2000"});
    const auto width = static_cast<std::size_t>(a.width);
    for_stripes(a.height, 0, threads, [&](const Stripe& stripe) {
        for (std::size_t i = width * static_cast<std::size_t>(stripe.first);
             i < width * static_cast<std::size_t>(stripe.last); ++i) {
            const Vec3d one = rgb_at(a, i);
            const Vec3d other = rgb_at(b, i);
            map.pixels[i] = one == other ? 0.0F : static_cast<float>(ciede2000(lab_of(one), lab_of(other)));
        }
    });
    return map;
}

}  // namespace lensproof::calibration
