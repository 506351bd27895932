// engine/scene/bsdf/mix.h — surfaces side by side, finer than can be seen: worn paint, dusty metal.
#pragma once
#include <array>
#include <optional>
#include <variant>

#include "engine/scene/bsdf/conductor.h"
#include "engine/scene/bsdf/dielectric.h"
#include "engine/scene/bsdf/diffuse.h"
#include "engine/scene/bsdf/plastic.h"

namespace lensproof::scene {

using SimpleBsdf = std::variant<DiffuseBsdf, ConductorBsdf, DielectricBsdf, PlasticBsdf, PaneBsdf>;

/// How many surfaces a mix may have.
inline constexpr std::size_t kMostMixed = 4;

/// f = Σ fraction · f_part over the first `count` parts; the fractions sum to 1.
struct MixBsdf {
    std::size_t count = 0;
    std::array<SimpleBsdf, kMostMixed> part;
    std::array<double, kMostMixed> fraction{};
};

// As in bsdf.h.
spectral::SpectralSample evaluate(const MixBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
double pdf(const MixBsdf& bsdf, const Vec3d& wo, const Vec3d& wi, Transport transport);
std::optional<BsdfSample> sample(const MixBsdf& bsdf, const Vec3d& wo, const BsdfNumbers& numbers, Transport transport);

}  // namespace lensproof::scene
