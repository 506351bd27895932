// engine/scene/material/dielectric_material.h — glass and the like, polished or rough.
#pragma once
#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "engine/scene/bsdf/dielectric.h"
#include "engine/scene/material/material_keys.h"

namespace lensproof::scene {

/// Made by `dielectric_material`.
struct DielectricMaterial {
    spectral::GridSpectrum eta;  // within over without
    Roughness roughness;         // `resolvable`
    std::shared_ptr<const BoundaryLosses> losses;
};

/// Glass of positive indices `eta` on the grid, polished where `roughness` is {}.
inline DielectricMaterial dielectric_material(spectral::GridSpectrum eta, const Roughness& roughness) {
    DielectricMaterial material{.eta = std::move(eta), .roughness = resolvable(roughness)};
    if (!material.roughness.is_smooth()) {
        const auto [least, most] = std::minmax_element(material.eta.value.begin(), material.eta.value.end());
        material.losses = std::make_shared<BoundaryLosses>(material.roughness, *least, *most);
    }
    return material;
}

inline bool reads_uv(const DielectricMaterial& /*even*/) {
    return false;
}

inline DielectricBsdf at_point(const DielectricMaterial& material, const Vec2d&,
                               const spectral::PathWavelengths& path) {
    return {.eta = material.eta(path), .roughness = material.roughness, .losses = material.losses.get()};
}

struct DielectricDescription {
    static constexpr KindNames<2> kNames{"dielectric", "rough-dielectric"};
    DielectricIndex index = 1.5;
    SpectrumDescription absorption_per_mm = 0.0;  // inside
    Roughness roughness;
};

inline void read_keys(DielectricDescription& dielectric, TomlTable& table, const NameIndex& /*earlier*/) {
    dielectric.roughness = read_roughness_of_kind(table);
    dielectric.index = read_index(table);
    if (table.has("absorption_per_mm")) {
        dielectric.absorption_per_mm = read_spectrum(table, "absorption_per_mm", kNotNegative, "absorption_per_mm");
    }
}

void visit_spectra(const DielectricDescription& dielectric, const auto& visit) {
    visit(dielectric.absorption_per_mm);
}

inline DielectricMaterial make_material(const DielectricDescription& dielectric, const MaterialMaker& maker) {
    return dielectric_material(maker.spectra.index(dielectric.index), dielectric.roughness);
}

/// What light loses inside, 1/mm; nothing where it loses none.
inline std::optional<spectral::GridSpectrum> absorption(const DielectricDescription& dielectric,
                                                        SceneSpectra& spectra) {
    const auto* even = std::get_if<double>(&dielectric.absorption_per_mm);
    if (even != nullptr && !(*even > 0.0)) {
        return {};
    }
    return spectra.at_midpoints(dielectric.absorption_per_mm);
}

}  // namespace lensproof::scene
