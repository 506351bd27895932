// engine/scene/material.h — what surfaces are made of: as a scene says it, and how it scatters at one point.
#pragma once
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "engine/scene/bsdf/bsdf.h"
#include "engine/scene/texture.h"

namespace lensproof::scene {

struct DiffuseMaterial {
    Texture albedo;  // in [0, 1]
};

/// Made by `conductor_material`.
struct ConductorMaterial {
    spectral::GridSpectrum n;
    spectral::GridSpectrum k;
    Roughness roughness;  // `resolvable`
    std::shared_ptr<const FacetLosses> losses;
    spectral::GridSpectrum given_back;
};

/// Made by `dielectric_material`.
struct DielectricMaterial {
    spectral::GridSpectrum eta;  // within over without
    Roughness roughness;         // `resolvable`
    std::shared_ptr<const BoundaryLosses> losses;
};

/// Made by `plastic_material`.
struct PlasticMaterial {
    Texture albedo;  // of the base under the coat, in [0, 1]
    std::shared_ptr<const DielectricCoat> coat;
};

using SimpleMaterial = std::variant<DiffuseMaterial, ConductorMaterial, DielectricMaterial, PlasticMaterial>;

/// Up to kMostMixed materials side by side.
struct MixMaterial {
    /// A material's share is the product of its factors, each a number or one less that number.
    struct Factor {
        ScalarTexture share;
        bool is_complement = false;
    };
    struct Part {
        SimpleMaterial material;
        std::vector<Factor> factors;
    };
    std::vector<Part> parts;
};

struct Material {
    std::variant<DiffuseMaterial, ConductorMaterial, DielectricMaterial, PlasticMaterial, MixMaterial> surface;
    std::optional<Texture> radiance;  // of light that it sends out on its outer side, W·m⁻²·sr⁻¹·nm⁻¹
};

/// A metal of index n + ik (at_midpoints of ComplexIndex, say) on the grid, polished where `roughness` is {}.
ConductorMaterial conductor_material(spectral::GridSpectrum n, spectral::GridSpectrum k, const Roughness& roughness);

/// Glass of positive indices `eta` on the grid, polished where `roughness` is {}.
DielectricMaterial dielectric_material(spectral::GridSpectrum eta, const Roughness& roughness);

/// A base of `albedo` under a clear coat of index `eta` > 1, whose facets have the slope `alpha`, 0 for smooth.
PlasticMaterial plastic_material(Texture albedo, double eta, double alpha);

/// `second` in a share of `share` (0 to 1), else `first`; both may be mixes themselves. What either emits is left out.
/// Throws InputError where more than kMostMixed materials come together.
MixMaterial mixed(const Material& first, const Material& second, const ScalarTexture& share);

/// How the material scatters at texture coordinates `uv`, at a path's wavelengths. The material must outlive it.
Bsdf bsdf_at(const Material& material, const Vec2d& uv, const spectral::PathWavelengths& path);

/// Its `radiance` there; black where it does not emit.
spectral::SpectralSample radiance_at(const Material& material, const Vec2d& uv, const spectral::PathWavelengths& path);

}  // namespace lensproof::scene
