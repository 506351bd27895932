#include "engine/optics/field_bundle.h"

#include <cmath>

namespace lensproof {

bool FieldBundle::is_near() const {
    return std::isfinite(object_distance) && object_distance > 0.0 && chief.front.direction.z > 0.0;
}

Ray<double> FieldBundle::ray(Vec2d offset) const {
    const Vec3d& along = chief.front.direction;
    const Vec3d across_x{1.0, 0.0, 0.0};
    const Vec3d across_y{0.0, along.z, -along.y};
    const Vec3d across = offset.x * across_x + offset.y * across_y;
    const Vec3d origin = chief.front.origin + across;
    if (!is_near()) {
        return {origin, along};
    }
    // From the object at distance R along the chief ray to `origin` it is √(R² + r²): r² / (R + √(R² + r²)) beyond the
    // wavefront.
    const double distance = (object_distance + chief.front.origin.z) / along.z;
    const double r2 = dot(across, across);
    const double to_origin = std::sqrt(distance * distance + r2);
    const Vec3d direction = (1.0 / to_origin) * (distance * along + across);
    return {origin - (r2 / (distance + to_origin)) * direction, direction};
}

}  // namespace lensproof
