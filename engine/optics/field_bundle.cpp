#include "engine/optics/field_bundle.h"

#include <cmath>
#include <utility>

#include "engine/base/infinity.h"

namespace lensproof::optics {

std::array<Vec3d, 2> across_axes(const Vec3d& along) {
    const double from_x = std::hypot(along.y, along.z);
    return {{{from_x, -along.x * along.y / from_x, -along.x * along.z / from_x},
             {0.0, along.z / from_x, -along.y / from_x}}};
}

Ray<double> ray_beside(const Ray<double>& axis, const std::array<Vec3d, 2>& across, double distance, Vec2d offset) {
    const Vec3d sideways = offset.x * across[0] + offset.y * across[1];
    const Vec3d origin = axis.origin + sideways;
    if (!std::isfinite(distance)) {
        return {origin, axis.direction};
    }
    // From the point at distance R along the axis to `origin` it is √(R² + r²): r² / (R + √(R² + r²)) beyond the
    // wavefront.
    const double r2 = dot(sideways, sideways);
    const double to_origin = std::sqrt(distance * distance + r2);
    const Vec3d direction = (1.0 / to_origin) * (distance * axis.direction + sideways);
    return {origin - (r2 / (distance + to_origin)) * direction, direction};
}

bool FieldBundle::is_near() const {
    return std::isfinite(object_distance) && object_distance > 0.0 && chief.front.direction.z > 0.0;
}

double FieldBundle::distance() const {
    return is_near() ? (object_distance + chief.front.origin.z) / chief.front.direction.z : kInfinity;
}

Vec3d FieldBundle::object_point() const {
    Vec3d point = chief.front.origin - distance() * chief.front.direction;
    point.z = -object_distance;
    return point;
}

namespace {

/// The chief ray from a near object point whose reference chief ray comes at `field_angle`: by the secant method on the
/// angle, from there. Near a lens whose pupil wanders more than one chief ray may come from a point; this is the
/// neighbour. Nothing where the steps leave the field or do not settle.
std::optional<ChiefRay> neighbouring_chief_ray(const ChiefRays& chief_rays, const Vec3d& object, double field_angle) {
    struct Try {
        double angle;
        ChiefRay ray;
        double miss;  // how far the object point is from the ray, mm, with a sign
    };
    const auto shoot = [&](double angle) -> std::optional<Try> {
        const std::optional<ChiefRay> ray = chief_rays.at_field(angle);
        if (!ray) {
            return std::nullopt;
        }
        const Vec3d from_ray = object - ray->front.origin;
        return Try{angle, *ray, ray->front.direction.z * from_ray.y - ray->front.direction.y * from_ray.z};
    };
    std::optional<Try> before = shoot(field_angle);
    constexpr double kFirstStep = 1e-6;
    std::optional<Try> here = shoot(field_angle - kFirstStep);
    constexpr int kMostSteps = 30;
    for (int i = 0; before && here && i < kMostSteps; ++i) {
        if (std::abs(before->miss) < std::abs(here->miss)) {
            std::swap(before, here);
        }
        const double step = here->miss * (here->angle - before->angle) / (here->miss - before->miss);
        // Twice the same miss: no more can be told.
        if (here->miss == before->miss || std::abs(step) <= 1e-14 * (1.0 + std::abs(here->angle))) {
            return here->ray;
        }
        before = std::exchange(here, shoot(here->angle - step));
    }
    return std::nullopt;
}

std::optional<ChiefRay> chief_ray_from(const FieldBundle& bundle, const ChiefRays& chief_rays) {
    const Vec3d object = bundle.object_point();
    if (object.x == 0.0 && bundle.chief.front.direction.x == 0.0) {
        if (const auto neighbour = neighbouring_chief_ray(chief_rays, object, bundle.chief.field_angle)) {
            return neighbour;
        }
    }
    return chief_rays.from_point(object);
}

}  // namespace

std::optional<FieldBundle> same_object(const FieldBundle& bundle, const ChiefRays& of_wavelength) {
    const std::optional<ChiefRay> own =
        bundle.is_near() ? chief_ray_from(bundle, of_wavelength) : of_wavelength.at_field(bundle.chief.field_angle);
    return own ? std::optional(FieldBundle{.chief = *own, .object_distance = bundle.object_distance}) : std::nullopt;
}

std::optional<FieldBundle> field_bundle(const ChiefRays& chief_rays, double field_angle, double object_distance) {
    const std::optional<ChiefRay> chief = chief_rays.at_field(field_angle);
    return chief ? std::optional(FieldBundle{.chief = *chief, .object_distance = object_distance}) : std::nullopt;
}

}  // namespace lensproof::optics
