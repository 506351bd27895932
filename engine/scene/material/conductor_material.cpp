#include "engine/scene/material/conductor_material.h"

#include <utility>
#include <variant>

namespace lensproof::scene {

namespace {

constexpr Bounds kMetalIndex{.min = 0.0, .max = 100.0, .min_excluded = true};
constexpr Bounds kExtinction{.min = 0.0, .max = 100.0};

ConductorIndex read_metal(TomlTable& table) {
    if (!table.has("ior")) {
        return {.n = read_spectrum(table, "n", kMetalIndex, "n"), .k = read_spectrum(table, "k", kExtinction, "k")};
    }
    if (table.has("n") || table.has("k")) {
        table.fail("ior", "stands beside n or k, expected one or the other");
    }
    const SpectrumDescription spectrum = read_spectrum(table, "ior", kMetalIndex, "n");
    if (const auto* name = std::get_if<SpectrumName>(&spectrum)) {
        return {.name = name->name};
    }
    if (const auto* both = std::get_if<SpectrumTable>(&spectrum)) {
        return {.n = SpectrumTable{both->file, "n"}, .k = SpectrumTable{both->file, "k"}};
    }
    table.fail("ior",
               "expected a metal's name such as \"metal:Ag\" or a table with the columns n and k; one number "
               "is no metal's index: n and k say two");
}

}  // namespace

ConductorMaterial conductor_material(spectral::GridSpectrum n, spectral::GridSpectrum k, const Roughness& roughness) {
    ConductorMaterial material{.n = std::move(n), .k = std::move(k), .roughness = resolvable(roughness)};
    if (material.roughness.is_smooth()) {
        return material;
    }
    material.losses = std::make_shared<FacetLosses>(FacetLosses::of_mirrors(material.roughness));
    for (std::size_t i = 0; i < material.n.value.size(); ++i) {
        const spectral::SpectralSample mean = mean_conductor_reflectance(spectral::SpectralSample(material.n.value[i]),
                                                                         spectral::SpectralSample(material.k.value[i]));
        material.given_back.value.push_back(static_cast<float>(given_back(mean[0], material.losses->mean())));
    }
    return material;
}

ConductorBsdf at_point(const ConductorMaterial& material, const Vec2d&, const spectral::PathWavelengths& path) {
    if (material.roughness.is_smooth()) {
        return {.n = material.n(path), .k = material.k(path)};
    }
    return {.n = material.n(path),
            .k = material.k(path),
            .roughness = material.roughness,
            .losses = material.losses.get(),
            .given_back = material.given_back(path)};
}

void read_keys(ConductorDescription& conductor, TomlTable& table, const NameIndex& /*earlier*/) {
    conductor.roughness = read_roughness_of_kind(table);
    conductor.index = read_metal(table);
}

}  // namespace lensproof::scene
