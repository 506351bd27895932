// calibration/sharpness/star_map.h — where a picture shows a Siemens star.
#pragma once
#include <array>
#include <cmath>

#include "engine/base/vec.h"

namespace lensproof::calibration {

/// From a picture to a star's own polar coordinates. A pixel at p belongs to the chart's angle
///     θ(p) = ∠ A⁻¹(p − c) + P(p − c) / (det A · |A⁻¹(p − c)|²),
/// for lines through the star's centre c are seen under an angle that the projection's derivative A there decides,
/// whatever the perspective; and a displacement u turns a spoke by its part at right angles to it alone,
/// (p − c) × u / |p − c|² in the picture, so that P takes up the lens's distortion: homogeneous polynomials of degree 1
/// to 4 for displacements of degree 0 to 3. Lengths in P are in units of `radius_px`.
struct StarMap {
    static constexpr int kBendTerms = 14;  // 2 + 3 + 4 + 5

    Vec2d centre_px;
    /// A: what 1 mm along the chart's x and y is at the centre, px. The chart's own x axis is any of its black sectors'
    /// first sides: they are alike.
    Vec2d x_axis;
    Vec2d y_axis;
    /// p = c + A q / (1 + g·q) for a point q of the chart, 1/mm: the outline's perspective.
    Vec2d perspective;
    double radius_px = 1.0;  // of the star, about
    std::array<double, kBendTerms> bend{};

    [[nodiscard]] double angle(const Vec2d& p) const;
    /// How θ(p) changes with each term of P: 2 of degree 1, x and y; 3 of degree 2; ….
    [[nodiscard]] std::array<double, kBendTerms> bend_terms(const Vec2d& p) const;
    /// How fast θ changes, rad/px.
    [[nodiscard]] double angle_per_px(const Vec2d& p) const;
    /// The picture's direction of a chart angle, without the bend; unit length.
    [[nodiscard]] Vec2d direction(double angle_rad) const;
    /// How far from the centre the chart's circle of `radius_mm` is seen in the direction of the pixel p, px.
    [[nodiscard]] double rim_px(const Vec2d& p, double radius_mm) const;
};

/// An ellipse; `angle_deg` of the longer half axis, from +x towards +y, in (-90, 90].
struct EllipseOutline {
    Vec2d centre_px;
    double long_half_axis_px = 0.0;
    double short_half_axis_px = 0.0;
    double angle_deg = 0.0;
};

/// What the chart's circle looks like.
EllipseOutline outline(const StarMap& map, double radius_mm);

}  // namespace lensproof::calibration
