#include "engine/scene/bsdf/ggx.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lensproof::scene {

namespace {

double squared(double x) {
    return x * x;
}

/// √(w.z² + α_x² w.x² + α_y² w.y²), which is w.z (1 + 2 Λ(w)).
double stretched_length(const Roughness& roughness, const Vec3d& w) {
    return std::sqrt(squared(w.z) + squared(roughness.alpha_x * w.x) + squared(roughness.alpha_y * w.y));
}

}  // namespace

Roughness resolvable(const Roughness& stated) {
    if (stated.alpha_x < kLeastAlpha && stated.alpha_y < kLeastAlpha) {
        return {};
    }
    return {.alpha_x = std::max(stated.alpha_x, kLeastAlpha), .alpha_y = std::max(stated.alpha_y, kLeastAlpha)};
}

double ggx_facets(const Roughness& roughness, const Vec3d& m) {
    const double stretched = squared(m.x / roughness.alpha_x) + squared(m.y / roughness.alpha_y) + squared(m.z);
    return 1.0 / (std::numbers::pi * roughness.alpha_x * roughness.alpha_y * squared(stretched));
}

double ggx_visible_per_cos(const Roughness& roughness, const Vec3d& w) {
    return 2.0 / (w.z + stretched_length(roughness, w));
}

Vec3d ggx_visible_normal(const Roughness& roughness, const Vec3d& wo, double u1, double u2) {
    // Facets become those of a hemisphere, whose visible normals are half-vectors of wo and a spherical cap.
    const Vec3d w = normalized(Vec3d{roughness.alpha_x * wo.x, roughness.alpha_y * wo.y, wo.z});
    const double z = (1.0 - u2) * (1.0 + w.z) - w.z;
    const double radius = std::sqrt(std::max(0.0, (1.0 - z) * (1.0 + z)));
    const double angle = 2.0 * std::numbers::pi * u1;
    const Vec3d half{radius * std::cos(angle) + w.x, radius * std::sin(angle) + w.y, z + w.z};
    return normalized(Vec3d{roughness.alpha_x * half.x, roughness.alpha_y * half.y, std::max(0.0, half.z)});
}

GgxReflection ggx_reflection(const Roughness& roughness, const Vec3d& wo, const Vec3d& wi) {
    const Vec3d m = normalized(wo + wi);
    // G₂ = 1 / (1 + Λ(wo) + Λ(wi)), value = D G₂ / (4 wo.z), pdf = D_visible / (4 wo·m), without their poles.
    const double length_o = stretched_length(roughness, wo);
    const double length_i = stretched_length(roughness, wi);
    const double half_facets = 0.5 * ggx_facets(roughness, m);
    return {.value = half_facets * wi.z / (length_o * wi.z + length_i * wo.z),
            .pdf = half_facets / (wo.z + length_o),
            .cos_facet = std::min(dot(wo, m), 1.0)};
}

double ggx_reflection_weight(const Roughness& roughness, const Vec3d& wo, const Vec3d& wi) {
    const double length_o = stretched_length(roughness, wo);
    const double length_i = stretched_length(roughness, wi);
    return wi.z * (wo.z + length_o) / (length_o * wi.z + length_i * wo.z);
}

}  // namespace lensproof::scene
