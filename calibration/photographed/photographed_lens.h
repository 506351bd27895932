// calibration/photographed/photographed_lens.h — a lens as it was calibrated from photographs: by lensfun, or its
// maker.
#pragma once
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/optics/projection.h"

namespace lensproof::calibration {

/// A radius from another: the sum of p[i] r^(i+1), both in units of PhotographedLens::unit_mm.
using RadialPolynomial = std::array<double, 7>;

/// One channel's lateral colour as lensfun has it: its radius over green's is v + c r + b r², r green's in units of
/// PhotographedLens::unit_mm.
struct ChannelScale {
    double v = 1.0;
    double c = 0.0;
    double b = 0.0;
};

/// As lensfun has it, or, as makers do, from the ideal radius as PhotographedLens::distortion.
using ChannelRadius = std::variant<ChannelScale, RadialPolynomial>;

struct LateralColour {
    ChannelRadius red;
    ChannelRadius blue;
};

/// Light at a fraction x of the half-diagonal over that on the axis: p(x) = 1 + k1 x² + k2 x⁴ + … (lensfun's "pa"), or
/// 1 / p(x) where that is what corrects it.
struct MeasuredVignetting {
    double f_number = 0.0;
    double distance_m = 0.0;  // of focus; lensfun writes 1000 for infinity
    std::array<double, 5> k{};
    bool corrects = false;

    [[nodiscard]] double brightness(double fraction) const;
};

/// What is said of a lens at one focal length, in lensfun's terms (lensfun.h 0.3.3; tests ask the library): a
/// direction at the angle θ from the axis, which `projection` without distortion images at r_u = F g(θ), is imaged at
///     r_d = Σ distortion[i] r_u^(i+1),
/// both in units of half the sensor's short side, `unit_mm`. F is nowhere stated: a free scale.
struct PhotographedLens {
    std::string source = "lensfun";  // or "dng": its maker's corrections
    std::string maker;
    std::string model;
    double crop_factor = 1.0;   // diagonal of 36 × 24 mm over that of the sensor it was photographed on
    double aspect_ratio = 1.5;  // long side over short side of the pictures
    optics::Projection projection = optics::Projection::rectilinear;
    double focal_length_mm = 0.0;  // nominal, at which it was calibrated
    std::string distortion_model;  // "poly3", "poly5", "ptlens", "warp-rectilinear"; empty: not calibrated
    RadialPolynomial distortion{1.0};
    std::optional<LateralColour> lateral_colour;
    std::vector<MeasuredVignetting> vignetting;  // by f-number, of each the farthest focus
    std::vector<std::string> remarks;            // sentences: what of the source is not in this

    [[nodiscard]] double half_diagonal_mm() const;
    [[nodiscard]] double unit_mm() const;
};

/// The radius (mm) where a point is photographed that a lens without distortion images at `ideal_mm`.
double photographed_radius(const PhotographedLens& lens, double ideal_mm);

/// d photographed / d ideal there; on the axis what the polynomial magnifies by.
double photographed_slope(const PhotographedLens& lens, double ideal_mm);

/// How far photographs go at all: the first ideal radius (mm) from which on the polynomial images no farther out, and
/// at most `largest_mm`.
double ideal_radius_covered(const PhotographedLens& lens, double largest_mm);

/// The ideal radius (mm) of what is photographed at `radius_mm`; nothing beyond where photographs go.
std::optional<double> ideal_radius(const PhotographedLens& lens, double radius_mm);

/// How far the channel's image lies outside of green's (mm), where green's is at `radius_mm`.
double channel_shift(const PhotographedLens& lens, const ChannelRadius& channel, double radius_mm);

/// Root mean square (mm) of what distinguishes the photographed lens from one without distortion of the best focal
/// length, evenly over image heights up to the half-diagonal: how much there is to tell lenses apart by.
double departure_from_ideal(const PhotographedLens& lens);

}  // namespace lensproof::calibration
