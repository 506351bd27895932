// engine/scene/material/conductor_material.h — metals, polished or rough.
#pragma once
#include <memory>
#include <string>

#include "engine/scene/bsdf/conductor.h"
#include "engine/scene/material/material_keys.h"

namespace lensproof::scene {

/// Made by `conductor_material`.
struct ConductorMaterial {
    spectral::GridSpectrum n;
    spectral::GridSpectrum k;
    Roughness roughness;  // `resolvable`
    std::shared_ptr<const FacetLosses> losses;
    spectral::GridSpectrum given_back;
};

/// A metal of index n + ik (at_midpoints of ComplexIndex, say) on the grid, polished where `roughness` is {}.
ConductorMaterial conductor_material(spectral::GridSpectrum n, spectral::GridSpectrum k, const Roughness& roughness);

inline bool reads_uv(const ConductorMaterial& /*even*/) {
    return false;
}

ConductorBsdf at_point(const ConductorMaterial& material, const Vec2d& uv, const spectral::PathWavelengths& path);

struct ConductorDescription {
    static constexpr KindNames<2> kNames{"conductor", "rough-conductor"};
    ConductorIndex index;
    Roughness roughness;
};

void read_keys(ConductorDescription& conductor, TomlTable& table, const NameIndex& earlier);

void visit_spectra(const ConductorDescription& conductor, const auto& visit) {
    visit(conductor.index.n);
    visit(conductor.index.k);
}

inline ConductorMaterial make_material(const ConductorDescription& conductor, const MaterialMaker& maker) {
    auto [n, k] = maker.spectra.metal(conductor.index);
    return conductor_material(std::move(n), std::move(k), conductor.roughness);
}

}  // namespace lensproof::scene
