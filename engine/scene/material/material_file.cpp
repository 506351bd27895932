#include "engine/scene/material/material_file.h"

#include <utility>

#include "engine/base/overloaded.h"

namespace lensproof::scene {

namespace {

/// Of what light does not enter, or is not said to.
std::optional<spectral::GridSpectrum> absorption(const auto& /*kind*/, SceneSpectra& /*spectra*/) {
    return {};
}

}  // namespace

std::vector<MaterialDescription> read_materials(TomlTable& top, NameIndex& names) {
    std::vector<MaterialDescription> materials;
    for (TomlTable& table : top.tables("materials")) {
        // Its own name comes after what it is made of, so that no mixture contains itself.
        const std::string called = table.choice("kind", kind_names<MaterialKind>());
        MaterialKind kind = of_kind<MaterialKind>(called, [&](auto& of_kind) { read_keys(of_kind, table, names); });
        const std::string name = names.add(table, "name", materials.size(), false);
        materials.push_back({.name = name, .kind = std::move(kind), .where = table.where()});
        table.finish();
    }
    return materials;
}

Material make_material(const MaterialDescription& material, const MaterialMaker& maker) {
    return std::visit([&](const auto& kind) { return Material{make_material(kind, maker)}; }, material.kind);
}

std::optional<spectral::GridSpectrum> absorption(const MaterialDescription& material, SceneSpectra& spectra) {
    return std::visit([&](const auto& kind) { return absorption(kind, spectra); }, material.kind);
}

std::vector<std::filesystem::path> named_files(const MaterialDescription& material) {
    std::vector<std::filesystem::path> files;
    const Overloaded add_file{[&](const SpectrumTable& table) { files.push_back(table.file); },
                              [&](const ImageDescription& image) { files.push_back(image.file); },
                              [](const auto& /*no file*/) {}};
    const auto add_files = [&](const auto& spectrum) { std::visit(add_file, spectrum); };
    std::visit([&](const auto& kind) { visit_spectra(kind, add_files); }, material.kind);
    return files;
}

}  // namespace lensproof::scene
