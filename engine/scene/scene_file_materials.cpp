#include <fmt/format.h>

#include "engine/scene/scene_file_parts.h"

namespace lensproof::scene {

namespace {

constexpr Bounds kReflectance{.min = 0.0, .max = 1.0};
constexpr Bounds kIndex{.min = 1.0, .max = 5.0};
constexpr Bounds kMetalIndex{.min = 0.0, .max = 100.0, .min_excluded = true};
constexpr Bounds kExtinction{.min = 0.0, .max = 100.0};
constexpr Bounds kRoughness{.min = 0.0, .max = 1.0};

DielectricIndex read_index(TomlTable& table, double fallback) {
    if (!table.has("ior")) {
        return table.number_or("ior", fallback, kIndex);
    }
    if (!table.is_text("ior")) {
        return table.number("ior", kIndex);
    }
    return SpectrumName{table.text("ior")};
}

RoughnessDescription read_roughness(TomlTable& table) {
    if (table.is_number("roughness")) {
        const double alpha = table.number("roughness", kRoughness);
        return {alpha, alpha};
    }
    const std::vector<double> alphas = table.numbers("roughness", 2, kRoughness);
    return {alphas[0], alphas[1]};
}

ConductorIndex read_metal(TomlTable& table) {
    if (table.has("ior")) {
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
    return {.n = read_spectrum(table, "n", kMetalIndex, "n"), .k = read_spectrum(table, "k", kExtinction, "k")};
}

MixDescription read_mix(TomlTable& table, const NameIndex& earlier) {
    const std::vector<std::string> of = table.texts("of");
    if (of.size() != 2) {
        table.fail("of", fmt::format("names {} materials, expected two that stand before this one", of.size()));
    }
    return {.first = earlier.find(table, "of", of[0]),
            .second = earlier.find(table, "of", of[1]),
            .share = table.number_or("share", 0.5, kReflectance)};
}

MaterialKind read_kind(TomlTable& table, const NameIndex& earlier) {
    const std::string kind = table.choice(
        "kind", {"diffuse", "conductor", "rough-conductor", "dielectric", "rough-dielectric", "plastic", "mix"});
    if (kind == "diffuse") {
        return DiffuseDescription{read_texture(table, "reflectance", kReflectance, "reflectance")};
    }
    if (kind == "mix") {
        return read_mix(table, earlier);
    }
    if (kind == "plastic") {
        return PlasticDescription{.reflectance = read_texture(table, "reflectance", kReflectance, "reflectance"),
                                  .index = read_index(table, 1.5),
                                  .roughness = table.has("roughness") ? read_roughness(table) : RoughnessDescription{}};
    }
    const RoughnessDescription roughness = kind.starts_with("rough-") ? read_roughness(table) : RoughnessDescription{};
    if (kind.ends_with("conductor")) {
        return ConductorDescription{.index = read_metal(table), .roughness = roughness};
    }
    DielectricDescription dielectric{.index = read_index(table, 1.5), .roughness = roughness};
    if (table.has("absorption_per_mm")) {
        dielectric.absorption_per_mm = read_spectrum(table, "absorption_per_mm", kNotNegative, "absorption_per_mm");
    }
    return dielectric;
}

}  // namespace

std::vector<MaterialDescription> read_materials(TomlTable& top, NameIndex& names) {
    std::vector<MaterialDescription> materials;
    for (TomlTable& table : top.tables("materials")) {
        // Its own name comes after what it is made of, so that no mixture contains itself.
        MaterialKind kind = read_kind(table, names);
        const std::string name = names.add(table, "name", materials.size(), false);
        materials.push_back({.name = name, .kind = std::move(kind), .where = table.where()});
        table.finish();
    }
    return materials;
}

}  // namespace lensproof::scene
