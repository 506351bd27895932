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
    spectral::SpectralSample tint{1.0F};     // of light that passes, from either side
};

/// A pane of such a medium, thinner than can be seen, both of whose smooth faces are met at once: of what they reflect
/// to and fro R' = 2R / (1 + R) comes back, and the rest goes on as it came. The same from either side.
struct PaneBsdf {
    spectral::SpectralSample eta;
    spectral::SpectralSample tint{1.0F};  // of light that passes
};

// As in bsdf.h.
spectral::SpectralSample evaluate(const DielectricBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
double pdf(const DielectricBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
std::optional<BsdfSample> sample(const DielectricBsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers,
                                 Transport transport);

spectral::SpectralSample evaluate(const PaneBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
double pdf(const PaneBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
std::optional<BsdfSample> sample(const PaneBsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers,
                                 Transport transport);

/// What a pane reflects at `cos_incidence` in [0, 1].
spectral::SpectralSample pane_reflectance(const PaneBsdf& pane, double cos_incidence);

/// Whether light meets the boundary as if it were smooth: as it is, or as the indices match and nothing bends.
bool is_delta(const DielectricBsdf& bsdf);

}  // namespace lensproof::scene
