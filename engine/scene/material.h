// engine/scene/material.h — what surfaces are made of: as a scene says it, and how it scatters at one point.
#pragma once
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "engine/scene/bsdf/bsdf.h"
#include "engine/scene/texture.h"

namespace lensproof {

struct DiffuseMaterial {
    Texture albedo;  // in [0, 1]
};

struct ConductorMaterial {
    GridSpectrum n;
    GridSpectrum k;
    Roughness roughness;  // `resolvable`
};

struct DielectricMaterial {
    GridSpectrum eta;     // within over without
    Roughness roughness;  // `resolvable`
};

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

/// `second` in a share of `share` (0 to 1), else `first`; both may be mixes themselves. What either emits is left out.
/// Throws InputError where more than kMostMixed materials come together.
MixMaterial mixed(const Material& first, const Material& second, const ScalarTexture& share);

/// How the material scatters at texture coordinates `uv`, at a path's wavelengths. The material must outlive it.
Bsdf bsdf_at(const Material& material, const Vec2d& uv, const PathWavelengths& path);

/// Its `radiance` there; black where it does not emit.
SpectralSample radiance_at(const Material& material, const Vec2d& uv, const PathWavelengths& path);

}  // namespace lensproof
