// engine/scene/bsdf/bsdf.h — how a surface scatters light at one point and a path's four wavelengths.
//
// The local frame's z is the shading normal and points to the surface's outside, x runs along the tangent. `wo` and
// `wi` are unit vectors that point away from the surface, below it (z < 0) for light that comes from inside or passes.
// `wo` is where a path comes from, `wi` where it goes on. What holds for the geometric normal is the caller's to check.
#pragma once
#include <optional>
#include <variant>

#include "engine/scene/bsdf/bsdf_sample.h"
#include "engine/scene/bsdf/mix.h"

namespace lensproof::scene {

using Bsdf = std::variant<DiffuseBsdf, ConductorBsdf, DielectricBsdf, PlasticBsdf, MixBsdf>;

/// f(wo, wi) |cos wi|, 1/sr. Deltas, which no given pair of directions meets, count as 0.
///
/// f(wo, wi) = f(wi, wo) for reflection. For transmission it is that of the adjoint transport: radiance's f(wo, wi) is
/// importance's f(wi, wo).
spectral::SpectralSample evaluate(const Bsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);

/// The pdf per solid angle at which `sample` draws `wi`, one for all of the path's wavelengths. It integrates to 1
/// less the probability of a delta and of no direction at all.
double pdf(const Bsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);

/// Draws `wi`. Nothing where light ends: the weight is then 0.
std::optional<BsdfSample> sample(const Bsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers, Transport transport);

/// Whether `evaluate` is 0 for every pair of directions: lights need not be sampled there.
bool is_delta(const Bsdf& bsdf);

/// Whether some of the light is scattered so.
bool has_delta(const Bsdf& bsdf);

/// The fraction of light from straight above that leaves the surface again, reflected or passed, as if facets lost
/// nothing: the albedo layer that denoisers ask for.
spectral::SpectralSample normal_albedo(const Bsdf& bsdf);

}  // namespace lensproof::scene
