// engine/scene/bsdf/conductor.h — metals, polished and rough.
#pragma once
#include <optional>

#include "engine/scene/bsdf/bsdf_sample.h"
#include "engine/scene/bsdf/facet_losses.h"
#include "engine/scene/bsdf/ggx.h"

namespace lensproof::scene {

/// Reflects by Fresnel's formulae for a complex index; rough, each facet of ggx.h does. Light that meets a second facet
/// is given back as facet_losses.h has it, so that what reflects everything returns everything; without `losses` it is
/// lost, from 6 % head on at α = 0.2 to 69 % at α = 1. Both faces are metal; light does not pass.
struct ConductorBsdf {
    spectral::SpectralSample n;  // the index is n + ik, relative to the medium outside
    spectral::SpectralSample k;
    Roughness roughness;                  // `resolvable`
    const FacetLosses* losses = nullptr;  // of this roughness's mirrors; outlives it
    spectral::SpectralSample given_back;  // the colour of light that meets several facets
};

/// F̄ = 2 ∫ F(μ) μ dμ, the reflectance of such a facet for evenly spread light.
spectral::SpectralSample mean_conductor_reflectance(const spectral::SpectralSample& n,
                                                    const spectral::SpectralSample& k);

// As in bsdf.h.
spectral::SpectralSample evaluate(const ConductorBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
double pdf(const ConductorBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
std::optional<BsdfSample> sample(const ConductorBsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers,
                                 Transport transport);

}  // namespace lensproof::scene
