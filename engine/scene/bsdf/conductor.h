// engine/scene/bsdf/conductor.h — metals, polished and rough.
#pragma once
#include <optional>

#include "engine/scene/bsdf/bsdf_sample.h"
#include "engine/scene/bsdf/ggx.h"

namespace lensproof {

/// Reflects by Fresnel's formulae for a complex index; rough, each facet of ggx.h does, once: light that meets a second
/// facet is lost, from 1 % at α = 0.2 to some 40 % at α = 1. Both faces are metal; light does not pass.
struct ConductorBsdf {
    SpectralSample n;  // the index is n + ik, relative to the medium outside
    SpectralSample k;
    Roughness roughness;  // `resolvable`
};

// As in bsdf.h.
SpectralSample evaluate(const ConductorBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
double density(const ConductorBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
std::optional<BsdfSample> sample(const ConductorBsdf& bsdf, const Vec3d& wo, double u_lobe, double u1, double u2,
                                 Transport transport);

}  // namespace lensproof
