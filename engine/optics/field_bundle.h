// engine/optics/field_bundle.h — the light of one object point before it enters the lens.
#pragma once
#include <array>

#include "engine/base/infinity.h"
#include "engine/optics/chief_ray.h"

namespace lensproof::optics {

/// Two unit vectors across the direction `along` and each other: the first as near to +x as can be, the second as near
/// to +y (in the plane x = 0: (1, 0, 0) and (0, z, −y)). Not for a direction along x.
std::array<Vec3d, 2> across_axes(const Vec3d& along);

/// The ray of a pencil at `offset` (mm) across its `axis`, in multiples of two unit vectors `across`: parallel to it,
/// or from the point `distance` mm before the axis's origin where that is finite. All origins lie on one wavefront,
/// next to the axis's (a plane, else a sphere around the point), so that differences of optical path from there are
/// those from the point and lose no digits to its distance.
Ray<double> ray_beside(const Ray<double>& axis, const std::array<Vec3d, 2>& across, double distance, Vec2d offset);

/// The rays of one object point around its chief ray. They are told apart by their offset (mm) across the chief ray at
/// its point on the first surface: x along +x, y in the meridional plane towards +y (where the chief ray has left the
/// plane x = 0: x as near to +x as can be across it). Lens space, mm, radians.
struct FieldBundle {
    ChiefRay chief;
    double object_distance = kInfinity;  // of the point's plane in front of z = 0, mm

    /// Whether the object point is so near that its rays are not parallel. Where the chief ray does not come from the
    /// object's plane (θ ≥ 90°) the point is taken as one at infinity.
    [[nodiscard]] bool is_near() const;

    /// The directions of an offset's x and y.
    [[nodiscard]] std::array<Vec3d, 2> across() const { return across_axes(chief.front.direction); }

    /// Along the chief ray from the object point to the chief ray's point on the first surface, mm; infinite where the
    /// object is not near.
    [[nodiscard]] double distance() const;

    /// The object point; it has to be near.
    [[nodiscard]] Vec3d object_point() const;

    /// The incoming ray at `offset`. All origins lie on one wavefront next to the first surface, see `ray_beside`.
    [[nodiscard]] Ray<double> ray(Vec2d offset) const { return ray_beside(chief.front, across(), distance(), offset); }
};

/// The bundle of the object at `field_angle`: at infinity the direction, else the point where the chief ray leaves the
/// object's plane. Nothing where there is no such ray.
std::optional<FieldBundle> field_bundle(const ChiefRays& chief_rays, double field_angle,
                                        double object_distance = kInfinity);

/// The bundle of the same object at another wavelength, around that wavelength's own chief ray: at infinity the same
/// direction, else the same point. Nothing where there is no such ray.
std::optional<FieldBundle> same_object(const FieldBundle& bundle, const ChiefRays& of_wavelength);

}  // namespace lensproof::optics
