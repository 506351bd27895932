// engine/pupil/rear_disc.h — a disc behind a lens that every path from the sensor into the lens crosses.
#pragma once
#include "engine/base/disc.h"
#include "engine/optics/trace.h"

namespace lensproof::pupil {

/// A disc around the axis in the plane z = plane_z, mm.
struct RearDisc : Disc {
    double plane_z = 0.0;
};

/// Every straight line from a point of the sensor, at most `sensor_radius_mm` from the axis, to a point of the rear
/// surface inside its rim crosses the disc before it meets that surface.
///
/// The plane stands at the largest z of the surface (behind an odd number of mirrors the least), at its rim or vertex.
/// A line from the sensor's point S to the surface's Q crosses it at (1 − τ) Q + τ S, τ = (plane_z − Q_z) / (S_z −
/// Q_z), at most (1 − τ)|Q| + τ|S| from the axis; the radius is the largest such number, bounded over the cells of a
/// polar grid on the surface by those of their corners. The sensor has to lie behind the surface.
RearDisc rear_disc(const optics::TraceLens<double>& lens, double sensor_radius_mm);

}  // namespace lensproof::pupil
