#include "engine/optics/meridional_bundle.h"

#include <cmath>

#include "engine/base/bisect.h"

namespace lensproof::optics {

MeridionalBundle meridional_bundle(const TraceLens<double>& lens, const ChiefRay& chief, double object_distance) {
    MeridionalBundle bundle{{.chief = chief, .object_distance = object_distance}};
    const auto last_passing = [&](double beyond) {
        constexpr int kHalvings = 50;
        const auto passes = [&](double offset) {
            return trace(lens, bundle.ray({0.0, offset})).status == RayStatus::ok;
        };
        return bisected({0.0, beyond}, kHalvings, passes).inside;
    };
    // No two points of the first surface are farther apart than its diameter and its depth, which on a sphere is at
    // most its semi-diameter.
    const double widest = 3.0 * std::sqrt(lens.surfaces.front().semi_diameter_squared);
    bundle.lower = last_passing(-widest);
    bundle.upper = last_passing(widest);
    return bundle;
}

}  // namespace lensproof::optics
