// engine/scene/bsdf/ggx.h — rough surfaces as tiny facets: their slopes, which of them are seen, and what they mirror.
//
// The distribution of B. Walter, S. Marschner, H. Li, K. Torrance, "Microfacet Models for Refraction through Rough
// Surfaces", EGSR 2007 (GGX), stretched along x and y, with Smith's masking; the notation is E. Heitz, "Understanding
// the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2), 2014. Directions w have w.z > 0.
#pragma once
#include "engine/base/vec.h"

namespace lensproof::scene {

/// The facets' root mean square slope along x and y, roughly; both 0 on a smooth surface.
struct Roughness {
    double alpha_x = 0.0;
    double alpha_y = 0.0;

    [[nodiscard]] bool is_smooth() const { return alpha_x == 0.0 && alpha_y == 0.0; }
};

/// Slopes below it, a third of an arc minute, are taken for smooth: lobes so narrow are deltas to every renderer.
inline constexpr double kLeastAlpha = 1e-4;

/// The roughness that is computed with: smooth where both slopes are below kLeastAlpha, else neither is.
Roughness resolvable(const Roughness& stated);

/// D(m), 1/sr: facets of normal m, as area per area of the surface and solid angle. ∫ D(m) m.z dm = 1.
double ggx_facets(const Roughness& roughness, const Vec3d& m);

/// G₁(w) / w.z = 2 / (w.z + √(w.z² + α_x² w.x² + α_y² w.y²)), G₁ being the fraction of w's view that facets do not
/// mask.
double ggx_visible_per_cos(const Roughness& roughness, const Vec3d& w);

/// A facet's normal as seen from `wo`, drawn with the pdf G₁(wo) (wo·m) D(m) / wo.z, from u1, u2 in (0, 1):
/// J. Dupuy, A. Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.
Vec3d ggx_visible_normal(const Roughness& roughness, const Vec3d& wo, double u1, double u2);

/// What single reflections at facets send from wi to wo, of facets that mirror everything.
struct GgxReflection {
    double value = 0.0;  // f |cos wi|, 1/sr, with masking and shadowing correlated by height (Heitz 2014, eq. 99)
    double pdf = 0.0;    // of wi, where m is drawn by ggx_visible_normal
    double cos_facet = 0.0;
};
GgxReflection ggx_reflection(const Roughness& roughness, const Vec3d& wo, const Vec3d& wi);

/// G₂ / G₁(wo): value / pdf of the above.
double ggx_reflection_weight(const Roughness& roughness, const Vec3d& wo, const Vec3d& wi);

/// `w` mirrored by a facet of normal m.
inline Vec3d reflected(const Vec3d& w, const Vec3d& m) {
    return 2.0 * dot(w, m) * m - w;
}

}  // namespace lensproof::scene
