#include "experiments/draw/palette.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lensproof::draw {

namespace {

struct LineColour {
    double wavelength_nm;
    std::array<int, 3> rgb;
};

/// What the eye calls the line, dark enough to stand on white; beyond the visible, darker with the distance.
constexpr std::array<LineColour, 12> kLineColours = {{{250.0, {0x33, 0x10, 0x4d}},
                                                      {365.0, {0x5c, 0x18, 0x96}},
                                                      {436.0, {0x45, 0x27, 0xc8}},
                                                      {486.0, {0x0a, 0x5f, 0xd6}},
                                                      {510.0, {0x00, 0x8c, 0x8c}},
                                                      {546.0, {0x1f, 0x8f, 0x1f}},
                                                      {588.0, {0x96, 0x84, 0x00}},
                                                      {610.0, {0xd0, 0x60, 0x00}},
                                                      {656.0, {0xd0, 0x1c, 0x1c}},
                                                      {707.0, {0xa0, 0x00, 0x28}},
                                                      {852.0, {0x7a, 0x40, 0x2e}},
                                                      {1100.0, {0x30, 0x24, 0x22}}}};

}  // namespace

FieldLine field_line(std::size_t index) {
    static constexpr std::array kColours = {"#2c0ea5", "#a79308", "#a10d4c", "#cb1eaf",
                                            "#65015d", "#6b510d", "#5b5efd", "#d07f5f"};
    constexpr std::size_t kTellApartInGrey = kColours.size() / 2;
    const bool is_again = index >= kColours.size();
    const bool is_dashed = index >= kTellApartInGrey;
    return {.colour = kColours[index % kColours.size()], .dashes = is_again ? "2 4" : is_dashed ? "10 4" : ""};
}

std::string series_colour(std::size_t index) {
    static constexpr std::array kColours = {"#0072b2", "#c64b00", "#008a64", "#a3478c",
                                            "#a87900", "#2f8fc4", "#7a4a2b", "#6b7280"};
    return kColours[index % kColours.size()];
}

std::string wavelength_colour(double wavelength_nm) {
    if (!std::isfinite(wavelength_nm) || wavelength_nm <= 0.0) {
        return kQuiet;
    }
    const double nm = std::clamp(wavelength_nm, kLineColours.front().wavelength_nm, kLineColours.back().wavelength_nm);
    const auto after = std::ranges::find_if(kLineColours.begin() + 1, kLineColours.end() - 1,
                                            [&](const LineColour& line) { return line.wavelength_nm >= nm; });
    const auto before = after - 1;
    const double t = (nm - before->wavelength_nm) / (after->wavelength_nm - before->wavelength_nm);
    const auto mixed = [&](std::size_t channel) {
        return static_cast<int>(std::lround((1.0 - t) * before->rgb[channel] + t * after->rgb[channel]));
    };
    return fmt::format("#{:02x}{:02x}{:02x}", mixed(0), mixed(1), mixed(2));
}

}  // namespace lensproof::draw
