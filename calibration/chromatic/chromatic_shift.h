// calibration/chromatic/chromatic_shift.h — how far red or blue lies from green.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "calibration/statistics/curve.h"
#include "engine/base/vec.h"

namespace lensproof::calibration {

/// The same chart point in green and in another channel, px.
struct ChromaticPair {
    Vec2d green_px;
    Vec2d channel_px;
    /// The only direction (a unit vector) in which the two are known: an edge's normal. None: both are.
    std::optional<Vec2d> normal = std::nullopt;
};

/// Displacement of a channel against green at q = (green − centre) / half-diagonal, ρ = |q|, with q⊥ = (−q_y, q_x):
///     d(q) = q (c1 + c3 ρ² + c5 ρ⁴) + q⊥ (s1 + s3 ρ²) + t.
/// Radially Δr(ρ) = c1 ρ + c3 ρ³ + c5 ρ⁵ px, positive outwards: a difference of focal length, then of distortion.
/// Tangentially Δt(ρ) = s1 ρ + s3 ρ³ px, positive clockwise as one sees the picture: 0 of every lens that is symmetric
/// about its axis, so what is not 0 there is the bench's (a filter that turned the camera, a chart that moved) or a
/// decentred element's. The translation t is what a tilted filter's wedge adds.
struct ChromaticShift {
    std::array<double, 3> radial_px{};      // c1, c3, c5
    std::array<double, 2> tangential_px{};  // s1, s3
    Vec2d translation_px;
    std::array<double, 49> covariance{};  // of c1, c3, c5, s1, s3, t_x, t_y
    double rms_px = 0.0;                  // of one coordinate of one pair, or of an edge
    int pairs_used = 0;
    Curve radial;      // Δr, px; sampled as far as pairs reach
    Curve tangential;  // Δt, px
};

/// Linear least squares; pairs beyond 4.5 robust standard deviations (a corner found wrongly in one channel) are left
/// out. Throws InputError for fewer than seven usable pairs or pairs that do not determine the terms (all at one
/// radius).
ChromaticShift fit_chromatic_shift(const std::vector<ChromaticPair>& pairs, const Vec2d& centre_px,
                                   double half_diagonal_px);

}  // namespace lensproof::calibration
