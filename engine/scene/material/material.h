// engine/scene/material/material.h — what surfaces are made of, and how it scatters at one point.
#pragma once
#include <variant>

#include "engine/scene/bsdf/bsdf.h"
#include "engine/scene/material/metallic_material.h"
#include "engine/scene/material/mix_material.h"

namespace lensproof::scene {

struct Material {
    std::variant<SimpleMaterial, MixMaterial, MetallicMaterial> surface;
};

/// Whether how it scatters depends on texture coordinates; else no hit needs to find them.
bool reads_uv(const Material& material);

/// How the material scatters at texture coordinates `uv`, at a path's wavelengths. The material must outlive it.
Bsdf bsdf_at(const Material& material, const Vec2d& uv, const spectral::PathWavelengths& path);

}  // namespace lensproof::scene
