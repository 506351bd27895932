// engine/pupil/entrance_beam.h — the light of a scene point, or from a direction, that meets a lens's first surface.
#pragma once
#include <array>
#include <optional>

#include "engine/base/infinity.h"
#include "engine/optics/trace.h"

namespace lensproof::pupil {

/// A sphere in lens space, mm.
struct BoundingSphere {
    Vec3d centre;
    double radius = 0.0;
};

/// A sphere that holds the part of the first surface inside its rim, about the rim's centre. Of a spherical surface it
/// is the one with the rim for its great circle: a cap's point r beside the axis and h above the rim's plane has
/// r² + h² = a² − 2 h (R − s), with the rim's radius a and the cap's depth s ≤ R. Of others the farthest of their
/// points on a grid, and 0.1 % more.
BoundingSphere front_sphere(const optics::TraceLens<double>& lens);

/// All rays of one scene point, or from one direction, that may meet the first surface inside its rim. They are told
/// apart by their offset (mm) in the plane through the front sphere's centre across the direction there from the point,
/// along x and y as the shortest turn from +z to that direction carries them: for one in the plane x = 0 those of
/// FieldBundle, and a beam turned about the axis has its offsets turned with it. Each ray that meets the sphere crosses
/// the plane within `radius` of its centre. No cosine of the field angle is divided by: light may come from the side
/// and from behind the first vertex, only not along −z.
struct EntranceBeam {
    Ray<double> axis;             // from the point through the sphere's centre
    std::array<Vec3d, 2> across;  // the offsets' x and y, unit vectors
    double distance = kInfinity;  // from the point to the sphere's centre, mm
    double radius = 0.0;          // mm

    [[nodiscard]] Ray<double> ray(Vec2d offset) const;

    /// Seen from a near point: dω / dA at the offset, sr/mm². A point of intensity I sends the flux I · this through
    /// each mm² there; light from a direction sends its irradiance.
    [[nodiscard]] double solid_angle_per_mm2(Vec2d offset) const;
};

/// The light that travels along `direction` (of unit length; field angle θ: {0, sin θ, cos θ}) to the sphere's centre
/// from `distance_mm` before it, which is more than the sphere's radius.
EntranceBeam beam_along(const BoundingSphere& front, const Vec3d& direction, double distance_mm = kInfinity);

/// The light of a scene point. Nothing where the point lies in the sphere: closer than the front element's own
/// semi-diameter to the centre of its rim.
std::optional<EntranceBeam> beam_from(const BoundingSphere& front, const Vec3d& point);

}  // namespace lensproof::pupil
