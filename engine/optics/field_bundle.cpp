#include "engine/optics/field_bundle.h"

#include <cmath>

namespace lensproof {

std::array<Vec3d, 2> across_axes(const Vec3d& along) {
    const double from_x = std::hypot(along.y, along.z);
    return {{{from_x, -along.x * along.y / from_x, -along.x * along.z / from_x},
             {0.0, along.z / from_x, -along.y / from_x}}};
}

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
    const std::array<Vec3d, 2> axes = across();
    const Vec3d sideways = offset.x * axes[0] + offset.y * axes[1];
    const Vec3d origin = chief.front.origin + sideways;
    if (!is_near()) {
        return {origin, along};
    }
    // From the object at distance R along the chief ray to `origin` it is √(R² + r²): r² / (R + √(R² + r²)) beyond the
    // wavefront.
    const double to_object = distance();
    const double r2 = dot(sideways, sideways);
    const double to_origin = std::sqrt(to_object * to_object + r2);
    const Vec3d direction = (1.0 / to_origin) * (to_object * along + sideways);
    return {origin - (r2 / (to_object + to_origin)) * direction, direction};
}

std::optional<FieldBundle> same_object(const FieldBundle& bundle, const ChiefRays& of_wavelength) {
    const std::optional<ChiefRay> own = bundle.is_near() ? of_wavelength.from_point(bundle.object_point())
                                                         : of_wavelength.at_field(bundle.chief.field_angle);
    return own ? std::optional(FieldBundle{.chief = *own, .object_distance = bundle.object_distance}) : std::nullopt;
}

std::optional<FieldBundle> field_bundle(const ChiefRays& of_wavelength, const ChiefRays& reference, double field_angle,
                                        double object_distance) {
    const std::optional<ChiefRay> aimed = reference.at_field(field_angle);
    if (!aimed) {
        return std::nullopt;
    }
    const FieldBundle bundle{.chief = *aimed, .object_distance = object_distance};
    return &of_wavelength == &reference ? std::optional(bundle) : same_object(bundle, of_wavelength);
}

}  // namespace lensproof
