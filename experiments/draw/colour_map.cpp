#include "experiments/draw/colour_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"
#include "engine/base/bisect.h"

namespace lensproof::draw {

namespace {

/// OKLab's lightness, chroma and hue to linear sRGB (Ottosson 2020).
Vec3d linear_srgb(double lightness, double chroma, double hue_deg) {
    const double hue = radians(hue_deg);
    const double a = chroma * std::cos(hue);
    const double b = chroma * std::sin(hue);
    const auto cube = [](double v) { return v * v * v; };
    const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
    const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
    const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
    return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
            -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
            -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool in_gamut(const Vec3d& rgb) {
    return std::min({rgb.x, rgb.y, rgb.z}) >= 0.0 && std::max({rgb.x, rgb.y, rgb.z}) <= 1.0;
}

/// The colour with as much chroma as sRGB holds, up to `most`. Along the chroma the gamut is left once.
Vec3d strongest(double lightness, double most, double hue_deg) {
    if (in_gamut(linear_srgb(lightness, most, hue_deg))) {
        return linear_srgb(lightness, most, hue_deg);
    }
    const auto is_shown = [&](double chroma) { return in_gamut(linear_srgb(lightness, chroma, hue_deg)); };
    return linear_srgb(lightness, bisected({0.0, most}, 30, is_shown).inside, hue_deg);
}

int srgb_byte(double linear) {
    const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
    return static_cast<int>(std::lround(255.0 * encoded));
}

}  // namespace

Vec3d map_colour(ColourMap map, double fraction) {
    const double t = std::clamp(std::isfinite(fraction) ? fraction : 0.0, 0.0, 1.0);
    if (map == ColourMap::sequential) {
        return strongest(0.17 + 0.76 * t, 0.15, 305.0 - 197.0 * t);
    }
    const double away = std::abs(2.0 * t - 1.0);
    return strongest(0.97 - 0.53 * away, 0.21 * away, t < 0.5 ? 255.0 : 30.0);
}

std::string map_colour_text(ColourMap map, double fraction) {
    const Vec3d rgb = map_colour(map, fraction);
    return fmt::format("#{:02x}{:02x}{:02x}", srgb_byte(rgb.x), srgb_byte(rgb.y), srgb_byte(rgb.z));
}

}  // namespace lensproof::draw
