// engine/pupil/rear_disc.h — a disc behind a lens that every path from the sensor into the lens crosses.
#pragma once
#include <numbers>

#include "engine/optics/trace.h"

namespace lensproof {

/// A disc around the axis in the plane z = plane_z, mm.
struct RearDisc {
    double plane_z = 0.0;
    double radius = 0.0;

    [[nodiscard]] double area() const { return std::numbers::pi * radius * radius; }
    [[nodiscard]] bool contains(Vec2d point) const { return point.x * point.x + point.y * point.y <= radius * radius; }

    /// The point that (u, v) in the unit square maps to, evenly over the disc (Shirley & Chiu, J. Graphics Tools 2(3),
    /// 1997).
    [[nodiscard]] Vec2d warped(double u, double v) const;
};

/// Every straight line from a point of the sensor, at most `sensor_radius_mm` from the axis, to a point of the rear
/// surface inside its rim crosses the disc before it meets that surface.
///
/// The plane stands at the largest z of the surface, at its rim or at its vertex. A line from the sensor's point S to
/// the surface's Q crosses it at (1 − τ) Q + τ S, τ = (plane_z − Q_z) / (S_z − Q_z), at most (1 − τ)|Q| + τ|S| from
/// the axis; the radius is the largest such number, bounded over the cells of a polar grid on the surface by those of
/// their corners. The sensor has to lie behind the surface.
RearDisc rear_disc(const TraceLens<double>& lens, double sensor_radius_mm);

}  // namespace lensproof
