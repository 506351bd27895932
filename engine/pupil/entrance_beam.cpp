#include "engine/pupil/entrance_beam.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/optics/field_bundle.h"
#include "engine/optics/surface_axes.h"
#include "engine/pupil/surface_cap.h"

namespace lensproof::pupil {

namespace {

/// About the rim's centre, in the surface's own axes.
BoundingSphere own_sphere(const SurfaceCap& cap) {
    const auto& [shape, rim] = cap;
    BoundingSphere sphere{.centre = {0.0, 0.0, optics::sag(shape, rim, 0.0)}, .radius = rim};
    if (shape.is_conic() && shape.conic == 0.0) {
        return sphere;
    }
    constexpr int kCells = 64;
    constexpr double kMargin = 1.001;
    double farthest = rim;
    for (int i = 0; i <= kCells; ++i) {
        const double radius = rim * std::sin(0.5 * std::numbers::pi * i / kCells);
        for (int k = 0; k <= kCells; ++k) {
            const double azimuth = 0.5 * std::numbers::pi * k / kCells;
            const double z = optics::sag(shape, radius * std::cos(azimuth), radius * std::sin(azimuth));
            farthest = std::max(farthest, std::hypot(radius, std::isfinite(z) ? z - sphere.centre.z : 0.0));
        }
    }
    sphere.radius = kMargin * farthest;
    return sphere;
}

}  // namespace

BoundingSphere front_sphere(const optics::TraceLens<double>& lens) {
    const optics::TraceSurface<double>& front = lens.surfaces.front();
    const BoundingSphere sphere = own_sphere(surface_cap(lens, front));
    return {.centre = optics::from_own_axes(lens, front, sphere.centre), .radius = sphere.radius};
}

Ray<double> EntranceBeam::ray(Vec2d offset) const {
    return optics::ray_beside(axis, across, distance, offset);
}

double EntranceBeam::solid_angle_per_mm2(Vec2d offset) const {
    const double to_offset2 = distance * distance + offset.x * offset.x + offset.y * offset.y;
    return std::isfinite(distance) ? distance / (to_offset2 * std::sqrt(to_offset2)) : 0.0;
}

EntranceBeam beam_along(const BoundingSphere& front, const Vec3d& direction, double distance_mm) {
    const Vec3d& d = direction;
    const double versine = 1.0 / (1.0 + d.z);  // of a turn by θ about (−d_y, d_x, 0): (1 − cos θ) / sin² θ
    EntranceBeam beam{.axis = {front.centre, d},
                      .across = {{{1.0 - versine * d.x * d.x, -versine * d.x * d.y, -d.x},
                                  {-versine * d.x * d.y, 1.0 - versine * d.y * d.y, -d.y}}},
                      .distance = distance_mm,
                      .radius = front.radius};
    if (std::isfinite(distance_mm)) {
        // Where the sphere's tangent cone, whose half angle has the sine radius / distance, crosses the plane.
        beam.radius *= distance_mm / std::sqrt((distance_mm - front.radius) * (distance_mm + front.radius));
    }
    return beam;
}

std::optional<EntranceBeam> beam_from(const BoundingSphere& front, const Vec3d& point) {
    const Vec3d towards = front.centre - point;
    const double distance = length(towards);
    return distance > front.radius ? std::optional(beam_along(front, (1.0 / distance) * towards, distance))
                                   : std::nullopt;
}

}  // namespace lensproof::pupil
