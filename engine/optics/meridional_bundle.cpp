#include "engine/optics/meridional_bundle.h"

#include <cmath>

namespace lensproof {

Ray<double> MeridionalBundle::ray(double offset) const {
    const Vec3d& along = chief.front.direction;
    const Vec3d across = normalized(Vec3d{0.0, along.z, -along.y});
    const Vec3d origin = chief.front.origin + offset * across;
    if (std::isinf(object_distance)) {
        return {origin, along};
    }
    const double to_object = (-object_distance - chief.front.origin.z) / along.z;
    const Vec3d object = chief.front.origin + to_object * along;
    return {origin, normalized(origin - object)};
}

MeridionalBundle meridional_bundle(const TraceLens<double>& lens, const ChiefRay& chief, double object_distance) {
    const bool near = object_distance > 0.0 && chief.front.direction.z > 0.0;
    MeridionalBundle bundle{.chief = chief,
                            .object_distance = near ? object_distance : std::numeric_limits<double>::infinity()};
    const auto last_passing = [&](double beyond) {
        constexpr int kHalvings = 50;
        double passing = 0.0;
        for (int i = 0; i < kHalvings; ++i) {
            const double middle = 0.5 * (passing + beyond);
            (trace(lens, bundle.ray(middle)).status == RayStatus::ok ? passing : beyond) = middle;
        }
        return passing;
    };
    // No two points of the first surface are farther apart than its diameter and its depth, which on a sphere is at
    // most its semi-diameter.
    const double widest = 3.0 * std::sqrt(lens.surfaces.front().semi_diameter_squared);
    bundle.lower = last_passing(-widest);
    bundle.upper = last_passing(widest);
    return bundle;
}

}  // namespace lensproof
