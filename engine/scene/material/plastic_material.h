// engine/scene/material/plastic_material.h — a diffuse body under a clear coat.
#pragma once
#include <cmath>
#include <memory>
#include <utility>

#include "engine/scene/bsdf/plastic.h"
#include "engine/scene/material/material_keys.h"

namespace lensproof::scene {

/// Made by `plastic_material`.
struct PlasticMaterial {
    Texture albedo;  // of the base under the coat, in [0, 1]
    std::shared_ptr<const DielectricCoat> coat;
};

/// A base of `albedo` under a clear coat of index `eta` > 1, whose facets have the slope `alpha`, 0 for smooth.
inline PlasticMaterial plastic_material(Texture albedo, double eta, double alpha) {
    return {.albedo = std::move(albedo), .coat = std::make_shared<DielectricCoat>(eta, alpha)};
}

inline bool reads_uv(const PlasticMaterial& material) {
    return varies(material.albedo);
}

inline PlasticBsdf at_point(const PlasticMaterial& material, const Vec2d& uv, const spectral::PathWavelengths& path) {
    return plastic_bsdf(value_at(material.albedo, uv, path), *material.coat);
}

struct PlasticDescription {
    static constexpr KindNames<> kNames{"plastic"};
    TextureDescription reflectance = 0.5;
    DielectricIndex index = 1.5;
    Roughness roughness;
};

inline void read_keys(PlasticDescription& plastic, TomlTable& table, const NameIndex& /*earlier*/) {
    plastic.reflectance = read_reflectance(table);
    plastic.index = read_index(table);
    plastic.roughness = table.has("roughness") ? read_roughness(table) : Roughness();
}

void visit_spectra(const PlasticDescription& plastic, const auto& visit) {
    visit(plastic.reflectance);
}

/// A coat is alike in every direction: as rough as the mean.
inline PlasticMaterial make_material(const PlasticDescription& plastic, const MaterialMaker& maker) {
    const double alpha = std::sqrt(plastic.roughness.alpha_x * plastic.roughness.alpha_y);
    return plastic_material(maker.spectra.texture(plastic.reflectance), SceneSpectra::index_at_d(plastic.index), alpha);
}

}  // namespace lensproof::scene
