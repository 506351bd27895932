// engine/optics/wall_finish.h — how the walls inside a lens scatter light: paint, ground edges, anodised tubes.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/vec.h"

namespace lensproof::optics {

/// A wall that scatters `albedo` of the light at every angle and absorbs the rest. Of what it scatters, `gloss` goes as
/// from a rough mirror and the others as Lambert's law has it. Both are reciprocal, and a wall of albedo 1 keeps all.
struct WallFinish {
    double albedo = 0.0;     // 0 to 1; black
    double gloss = 0.0;      // 0 to 1
    double roughness = 0.3;  // of the mirror, 0 to 1: α of the GGX distribution of its facets' slopes

    bool operator==(const WallFinish&) const = default;
};

/// A direction by Lambert's law about +z, from two numbers in (0, 1).
inline Vec3d lambert_direction(double u, double v) {
    const double sine = std::sqrt(u);
    const double azimuth = 2.0 * std::numbers::pi * v;
    return {sine * std::cos(azimuth), sine * std::sin(azimuth), std::sqrt(1.0 - u)};
}

/// The part of Smith's height distribution that GGX facets let a direction see (Heitz 2014, eq. 72); below the horizon
/// of the other sign, less 1.
inline double smith_lambda(const Vec3d& w, double roughness) {
    const double slope = roughness * std::sqrt(std::max(0.0, 1.0 - w.z * w.z)) / w.z;
    return 0.5 * (std::copysign(std::sqrt(1.0 + slope * slope), w.z) - 1.0);
}

/// The normal of a GGX facet as seen from `towards`, from above or below (Dupuy & Benyoub, "Sampling Visible GGX
/// Normals with Spherical Caps", HPG 2023): that of a sphere's reflections, stretched.
inline Vec3d visible_facet(const Vec3d& towards, double roughness, double u, double v) {
    const Vec3d seen = normalized(Vec3d{roughness * towards.x, roughness * towards.y, towards.z});
    const double z = (1.0 - u) * (1.0 + seen.z) - seen.z;
    const double across = std::sqrt(std::max(0.0, 1.0 - z * z));
    const double azimuth = 2.0 * std::numbers::pi * v;
    const Vec3d middle = Vec3d{across * std::cos(azimuth), across * std::sin(azimuth), z} + seen;
    return normalized(Vec3d{roughness * middle.x, roughness * middle.y, middle.z});
}

/// Light that comes along `direction` (z < 0) to a rough mirror leaves it along what this returns, after as many facets
/// as it takes: no light is lost between them (Heitz, Hanika, d'Eon & Dachsbacher, "Multiple-Scattering Microfacet
/// BSDFs with the Smith Model", SIGGRAPH 2016). Of a height only its quantile among facets matters. `numbers()` draws
/// from (0, 1).
template <class Numbers>
Vec3d reflected_by_facets(Vec3d direction, double roughness, Numbers& numbers) {
    constexpr int kMostFacets = 1000;  // a handful, as a rule
    double quantile = 1.0;
    for (int facets = 0; facets < kMostFacets; ++facets) {
        const double lambda = smith_lambda(direction, roughness);
        quantile *= std::pow(numbers(), -1.0 / lambda);
        if (facets > 0 && !(quantile < 1.0)) {
            return direction;
        }
        const double u = numbers();
        const Vec3d normal = visible_facet(-1.0 * direction, roughness, u, numbers());
        direction = direction - (2.0 * dot(direction, normal)) * normal;
    }
    return {0.0, 0.0, 1.0};
}

/// Where what a wall scatters goes; its normal is +z, `direction` has z < 0.
template <class Numbers>
Vec3d scattered_direction(const WallFinish& finish, const Vec3d& direction, Numbers& numbers) {
    if (numbers() < finish.gloss) {
        return reflected_by_facets(direction, finish.roughness, numbers);
    }
    const double u = numbers();
    return lambert_direction(u, numbers());
}

/// What is inside a lens beside its glass. All are black unless a file says otherwise.
struct BarrelFinish {
    WallFinish tube;    // between elements, and the mounts around them
    WallFinish edges;   // of elements, between their two faces
    WallFinish blades;  // of the stop

    [[nodiscard]] bool is_black() const { return !(tube.albedo > 0.0 || edges.albedo > 0.0 || blades.albedo > 0.0); }
    bool operator==(const BarrelFinish&) const = default;
};

}  // namespace lensproof::optics
