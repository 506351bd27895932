// engine/scene/material/diffuse_material.h — matt surfaces.
#pragma once
#include "engine/scene/bsdf/diffuse.h"
#include "engine/scene/material/material_keys.h"

namespace lensproof::scene {

struct DiffuseMaterial {
    Texture albedo;  // in [0, 1]
};

inline bool reads_uv(const DiffuseMaterial& material) {
    return varies(material.albedo);
}

inline DiffuseBsdf at_point(const DiffuseMaterial& material, const Vec2d& uv, const spectral::PathWavelengths& path) {
    return {.albedo = value_at(material.albedo, uv, path)};
}

struct DiffuseDescription {
    static constexpr KindNames<> kNames{"diffuse"};
    TextureDescription reflectance = 0.5;
};

inline void read_keys(DiffuseDescription& diffuse, TomlTable& table, const NameIndex& /*earlier*/) {
    diffuse.reflectance = read_reflectance(table);
}

void visit_spectra(const DiffuseDescription& diffuse, const auto& visit) {
    visit(diffuse.reflectance);
}

inline DiffuseMaterial make_material(const DiffuseDescription& diffuse, const MaterialMaker& maker) {
    return {maker.spectra.texture(diffuse.reflectance)};
}

}  // namespace lensproof::scene
