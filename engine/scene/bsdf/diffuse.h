// engine/scene/bsdf/diffuse.h — Lambert's surface, equally bright from everywhere.
#pragma once
#include <optional>

#include "engine/scene/bsdf/bsdf_sample.h"

namespace lensproof::scene {

/// f = albedo / π, the same on both of its faces; light does not pass.
struct DiffuseBsdf {
    spectral::SpectralSample albedo;  // in [0, 1]
};

// As in bsdf.h.
spectral::SpectralSample evaluate(const DiffuseBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
double pdf(const DiffuseBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
std::optional<BsdfSample> sample(const DiffuseBsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers,
                                 Transport transport);

}  // namespace lensproof::scene
