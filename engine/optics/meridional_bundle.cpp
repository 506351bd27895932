#include "engine/optics/meridional_bundle.h"

#include <cmath>

namespace lensproof::optics {

MeridionalBundle meridional_bundle(const TraceLens<double>& lens, const ChiefRay& chief, double object_distance) {
    MeridionalBundle bundle{{.chief = chief, .object_distance = object_distance}};
    const auto last_passing = [&](double beyond) {
        constexpr int kHalvings = 50;
        double passing = 0.0;
        for (int i = 0; i < kHalvings; ++i) {
            const double middle = 0.5 * (passing + beyond);
            (trace(lens, bundle.ray({0.0, middle})).status == RayStatus::ok ? passing : beyond) = middle;
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

}  // namespace lensproof::optics
