// engine/scene/material/mix_material.h — materials side by side.
#pragma once
#include <algorithm>
#include <variant>
#include <vector>

#include "engine/scene/bsdf/mix.h"
#include "engine/scene/material/conductor_material.h"
#include "engine/scene/material/dielectric_material.h"
#include "engine/scene/material/diffuse_material.h"
#include "engine/scene/material/plastic_material.h"

namespace lensproof::scene {

using SimpleMaterial = std::variant<DiffuseMaterial, ConductorMaterial, DielectricMaterial, PlasticMaterial>;

/// Up to kMostMixed materials side by side.
struct MixMaterial {
    struct Part {
        SimpleMaterial material;
        double fraction = 1.0;
    };
    std::vector<Part> parts;
};

/// `fraction` (0 to 1) of `second`, the rest of `first`; both may be mixes themselves.
/// Throws InputError where more than kMostMixed materials come together.
MixMaterial mixed(const Material& first, const Material& second, double fraction);

inline bool reads_uv(const MixMaterial& material) {
    return std::ranges::any_of(material.parts, [](const MixMaterial::Part& part) {
        return std::visit([](const auto& simple) { return reads_uv(simple); }, part.material);
    });
}

MixBsdf at_point(const MixMaterial& material, const Vec2d& uv, const spectral::PathWavelengths& path);

/// `fraction` of the second of two materials, the rest of the first; both indices of `SceneDescription::materials`,
/// below the mixture's own.
struct MixDescription {
    static constexpr KindNames<> kNames{"mix"};
    std::size_t first = 0;
    std::size_t second = 0;
    double fraction = 0.5;
};

void read_keys(MixDescription& mix, TomlTable& table, const NameIndex& earlier);

void visit_spectra(const MixDescription& /*of others*/, const auto& /*visit*/) {}

MixMaterial make_material(const MixDescription& mix, const MaterialMaker& maker);

}  // namespace lensproof::scene
