// engine/scene/bsdf/dielectric.h — glass, water: boundaries that reflect a part of the light and refract the rest.
#pragma once
#include <optional>

#include "engine/scene/bsdf/bsdf_sample.h"
#include "engine/scene/bsdf/facet_losses.h"
#include "engine/scene/bsdf/ggx.h"

namespace lensproof::scene {

/// The boundary between the outside, z > 0, and a medium of index `eta` relative to it.
///
/// Smooth, Fresnel's formulae and Snell's law; where the wavelengths' indices differ, refraction disperses them and
/// only the hero goes on. Rough, each facet of ggx.h does so once (Walter et al. 2007). There all wavelengths go on:
/// the direction is drawn from one of them, each as often, and weighed by the mean of their pdfs (Wilkie et al.
/// 2014). Masking is correlated by height where light is reflected, independent on the two sides where it passes
/// (Walter's eq. 23). Light that meets a second facet is given back by facet_losses.h, on both sides, so that nothing
/// is lost; without `losses` it is.
struct DielectricBsdf {
    spectral::SpectralSample eta;            // positive
    Roughness roughness;                     // `resolvable`
    const BoundaryLosses* losses = nullptr;  // of this roughness and such indices; outlives it
};

// As in bsdf.h.
spectral::SpectralSample evaluate(const DielectricBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
double pdf(const DielectricBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
std::optional<BsdfSample> sample(const DielectricBsdf& bsdf, const Vec3d& wo, double u_lobe, double u1, double u2,
                                 Transport transport);

/// Whether light meets the boundary as if it were smooth: as it is, or as the indices match and nothing bends.
bool is_delta(const DielectricBsdf& bsdf);

}  // namespace lensproof::scene
