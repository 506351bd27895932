// tests/engine/optics/packet/rays_at.h — rays of every fate.
#pragma once
#include <cmath>
#include <random>
#include <vector>

#include "engine/optics/lens.h"

namespace lensproof::optics {

/// Rays towards the front of `lens` from all sides, so that some pass, some are clipped, miss or are reflected.
inline std::vector<Ray<double>> rays_at(const Lens& lens, int count, double steepest) {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<Ray<double>> rays;
    const double reach = 1.2 * lens.surfaces.front().semi_diameter;
    for (int i = 0; i < count; ++i) {
        const double angle = steepest * unit(random);
        const Vec3d direction = normalized(Vec3d{0.2 * unit(random), std::sin(angle), std::cos(angle)});
        const Vec3d at{reach * unit(random), reach * unit(random), 0.0};
        rays.push_back({at - 40.0 * direction, direction});
    }
    return rays;
}

}  // namespace lensproof::optics
