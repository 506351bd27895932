// engine/scene/bsdf/plastic.h — plastic, varnish, glazed paint: pigment under a clear coat.
#pragma once
#include <optional>

#include "engine/scene/bsdf/bsdf_sample.h"
#include "engine/scene/bsdf/coat.h"

namespace lensproof::scene {

/// A Lambertian base of albedo ρ under a DielectricCoat, light bouncing between the two without end. With E the coat's
/// reflectance from above, Ē its mean and F̄ its mean from below,
///     f = f_coat + (1 − E(wo)) (1 − E(wi)) / (π (1 − Ē)) · ρ (1 − F̄) / (1 − ρ F̄)
/// (J. L. Saunderson, J. Opt. Soc. Am. 32, 727 (1942), for the bounces; the path in and out as C. Kelemen, L.
/// Szirmay-Kalos, Eurographics 2001 short papers, so that it is reciprocal). From wo it returns
/// E(wo) + (1 − E(wo)) ρ (1 − F̄) / (1 − ρ F̄) in all, which is 1 where ρ is. What single reflections at a rough coat's
/// facets lose goes to the base. Both faces are coated; light does not pass.
struct PlasticBsdf {
    spectral::SpectralSample base;         // ρ (1 − F̄) / (1 − ρ F̄), in [0, 1]
    const DielectricCoat* coat = nullptr;  // outlives it
    Roughness roughness;  // `resolvable`: the coat's own, or near it where that varies over the surface
};

/// With a base of albedo ρ in [0, 1].
PlasticBsdf plastic_bsdf(const spectral::SpectralSample& albedo, const DielectricCoat& coat);

// As in bsdf.h.
spectral::SpectralSample evaluate(const PlasticBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
double pdf(const PlasticBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
std::optional<BsdfSample> sample(const PlasticBsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers,
                                 Transport transport);

}  // namespace lensproof::scene
