// engine/scene/material/material_keys.h — keys that several kinds of materials have in files, and what they are made
// with.
#pragma once
#include <vector>

#include "engine/base/kinds.h"
#include "engine/base/toml_keys.h"
#include "engine/scene/bsdf/ggx.h"
#include "engine/scene/spectra/scene_spectra.h"
#include "engine/scene/spectra/spectrum_keys.h"

namespace lensproof::scene {

struct Material;

/// A scene that is being built: its spectra, and its materials so far.
struct MaterialMaker {
    SceneSpectra& spectra;
    const std::vector<Material>& earlier;
};

inline constexpr Bounds kUpToOne{.min = 0.0, .max = 1.0};

/// GGX's α along u and across it, a number for both or one each.
inline Roughness read_roughness(TomlTable& table) {
    if (table.is_number("roughness")) {
        const double alpha = table.number("roughness", kUpToOne);
        return {alpha, alpha};
    }
    const std::vector<double> alphas = table.numbers("roughness", 2, kUpToOne);
    return {alphas[0], alphas[1]};
}

/// Of kinds that are called "rough-" where they are.
inline Roughness read_roughness_of_kind(TomlTable& table) {
    return table.text("kind").starts_with("rough-") ? read_roughness(table) : Roughness();
}

/// 1.5 where it is absent.
inline DielectricIndex read_index(TomlTable& table) {
    if (table.has("ior") && table.is_text("ior")) {
        return SpectrumName{table.text("ior")};
    }
    return table.number_or("ior", 1.5, {.min = 1.0, .max = 5.0});
}

inline TextureDescription read_reflectance(TomlTable& table) {
    return read_texture(table, "reflectance", kUpToOne, "reflectance");
}

}  // namespace lensproof::scene
