#include "engine/optics/field_bundle.h"

#include <cmath>

namespace lensproof {

bool FieldBundle::is_near() const {
    return std::isfinite(object_distance) && object_distance > 0.0 && chief.front.direction.z > 0.0;
}

double FieldBundle::distance() const {
    return is_near() ? (object_distance + chief.front.origin.z) / chief.front.direction.z
                     : std::numeric_limits<double>::infinity();
}

Vec3d FieldBundle::object_point() const {
    Vec3d point = chief.front.origin - distance() * chief.front.direction;
    point.z = -object_distance;
    return point;
}

Ray<double> FieldBundle::ray(Vec2d offset) const {
    const Vec3d& along = chief.front.direction;
    // +x made perpendicular to the chief ray, and what completes the frame. In the plane x = 0 these are
    // (1, 0, 0) and (0, z, −y).
    const double across_yz = std::hypot(along.y, along.z);
    const Vec3d across_x{across_yz, -along.x * along.y / across_yz, -along.x * along.z / across_yz};
    const Vec3d across_y{0.0, along.z / across_yz, -along.y / across_yz};
    const Vec3d across = offset.x * across_x + offset.y * across_y;
    const Vec3d origin = chief.front.origin + across;
    if (!is_near()) {
        return {origin, along};
    }
    // From the object at distance R along the chief ray to `origin` it is √(R² + r²): r² / (R + √(R² + r²)) beyond the
    // wavefront.
    const double to_object = distance();
    const double r2 = dot(across, across);
    const double to_origin = std::sqrt(to_object * to_object + r2);
    const Vec3d direction = (1.0 / to_origin) * (to_object * along + across);
    return {origin - (r2 / (to_object + to_origin)) * direction, direction};
}

std::optional<FieldBundle> field_bundle(const ChiefRays& of_wavelength, const ChiefRays& reference, double field_angle,
                                        double object_distance) {
    const std::optional<ChiefRay> aimed = reference.at_field(field_angle);
    if (!aimed) {
        return std::nullopt;
    }
    FieldBundle bundle{.chief = *aimed, .object_distance = object_distance};
    if (&of_wavelength == &reference) {
        return bundle;
    }
    const std::optional<ChiefRay> own =
        bundle.is_near() ? of_wavelength.from_point(bundle.object_point()) : of_wavelength.at_field(field_angle);
    if (!own) {
        return std::nullopt;
    }
    bundle.chief = *own;
    return bundle;
}

}  // namespace lensproof
