// engine/optics/meridional_bundle.h — the rays of a field point in the meridional plane, from rim to rim.
#pragma once
#include <limits>

#include "engine/optics/chief_ray.h"

namespace lensproof {

/// The rays of one object point in the plane of a chief ray. They are told apart by their offset (mm) across the chief
/// ray at its point on the first surface, positive towards +y. Lens space, mm, radians.
struct MeridionalBundle {
    ChiefRay chief;
    double object_distance = std::numeric_limits<double>::infinity();  // in front of the first vertex
    double lower = 0.0;  // offsets of the outermost rays that pass every rim; lower ≤ 0 ≤ upper
    double upper = 0.0;

    /// The incoming ray at `offset`, its origin next to the first surface. An object at infinity sends parallel rays,
    /// a near one, where the chief ray crosses its plane, rays from that point.
    [[nodiscard]] Ray<double> ray(double offset) const;
};

/// The bundle around `chief`, which passes. Its ends are found by bisection, so the offsets that pass are taken to be
/// one interval: a ray that misses, is clipped, stopped or totally reflected bounds it. A near object whose plane the
/// chief ray does not come from (θ ≥ 90°) is taken as one at infinity.
MeridionalBundle meridional_bundle(const TraceLens<double>& lens, const ChiefRay& chief,
                                   double object_distance = std::numeric_limits<double>::infinity());

}  // namespace lensproof
