// tests/engine/scene/bsdf/bsdf_cases.h — surfaces and directions that the tests of scattering share.
#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "engine/scene/bsdf/bsdf.h"

namespace lensproof::scene {

/// Numbers in (0, 1), the same on every machine.
class Uniform {
  public:
    explicit Uniform(std::uint64_t seed) : bits_(seed) {}
    double operator()() { return (static_cast<double>(bits_() >> 11U) + 0.5) * 0x1p-53; }

  private:
    std::mt19937_64 bits_;
};

/// A unit vector of cosine `mu` and azimuth `phi`.
inline Vec3d direction(double mu, double phi) {
    const double sine = std::sqrt((1.0 - mu) * (1.0 + mu));
    return {sine * std::cos(phi), sine * std::sin(phi), mu};
}

/// Evenly over the sphere.
inline Vec3d random_direction(Uniform& uniform) {
    const double mu = 2.0 * uniform() - 1.0;
    return direction(mu, 2.0 * std::numbers::pi * uniform());
}

struct BsdfCase {
    std::string name;
    Bsdf bsdf;
};

/// What some surfaces refer to.
struct BsdfTables {
    DielectricCoat smooth_coat{1.5, 0.0};
    DielectricCoat rough_coat{1.5, 0.3};
    Roughness brushed{.alpha_x = 0.5, .alpha_y = 0.15};
    Roughness frosted{.alpha_x = 0.4, .alpha_y = 0.4};
    FacetLosses metal_losses = FacetLosses::of_mirrors(brushed);
    BoundaryLosses glass_losses{frosted, 1.5, 1.5};
    BoundaryLosses prism_losses{frosted, 1.5, 1.6};
};

/// Rough and diffuse surfaces: each with a pdf over directions. `tables` must outlive them.
inline std::vector<BsdfCase> broad_cases(const BsdfTables& tables) {
    const spectral::SpectralSample albedo({0.9F, 0.5F, 0.2F, 0.05F});
    const DiffuseBsdf diffuse{.albedo = albedo};
    const ConductorBsdf metal{.n = spectral::SpectralSample({0.2F, 0.6F, 1.3F, 1.4F}),
                              .k = spectral::SpectralSample({3.5F, 2.1F, 1.9F, 1.8F}),
                              .roughness = {.alpha_x = 0.3, .alpha_y = 0.3}};
    ConductorBsdf brushed = metal;
    brushed.roughness = tables.brushed;
    ConductorBsdf lossless_metal = brushed;
    lossless_metal.losses = &tables.metal_losses;
    lossless_metal.given_back = spectral::SpectralSample({0.9F, 0.5F, 0.2F, 0.2F});
    const DielectricBsdf frosted{.eta = spectral::SpectralSample(1.5F), .roughness = tables.frosted};
    DielectricBsdf lossless_glass = frosted;
    lossless_glass.losses = &tables.glass_losses;
    const DielectricBsdf prism{.eta = spectral::SpectralSample({1.5F, 1.53F, 1.56F, 1.6F}),
                               .roughness = {.alpha_x = 0.3, .alpha_y = 0.2}};
    DielectricBsdf lossless_prism = prism;
    lossless_prism.roughness = tables.frosted;
    lossless_prism.losses = &tables.prism_losses;
    MixBsdf mix;
    mix.count = 3;
    mix.part = {diffuse, brushed, lossless_glass};
    mix.fraction = {0.25, 0.25, 0.5};
    return {{"diffuse", diffuse},
            {"metal", metal},
            {"brushed metal", brushed},
            {"lossless metal", lossless_metal},
            {"frosted glass", frosted},
            {"frosted prism", prism},
            {"lossless glass", lossless_glass},
            {"lossless prism", lossless_prism},
            {"smooth plastic", plastic_bsdf(albedo, tables.smooth_coat)},
            {"rough plastic", plastic_bsdf(albedo, tables.rough_coat)},
            {"mix", mix}};
}

}  // namespace lensproof::scene
