// engine/scene/material/material_file.h — the materials of a scene file.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/scene/material/material.h"

namespace lensproof::scene {

/// The kinds, each in a file of its own, which has besides what it says
///
///     kNames               what files call it
///     read_keys            its keys
///     visit_spectra        the spectra and textures among them
///     make_material        one of `SimpleMaterial`, or a mix
///     absorption           of light inside bodies of it, where there is any
///     at_point             of what is made: how it scatters there, one of `SimpleBsdf` (engine/scene/bsdf/bsdf.h)
using MaterialKind =
    std::variant<DiffuseDescription, ConductorDescription, DielectricDescription, PlasticDescription, MixDescription>;

struct MaterialDescription {
    std::string name;
    MaterialKind kind;
    std::string where;  // "scene.toml:12: materials[2]", for later complaints
};

/// Throws InputError naming file, line and key.
std::vector<MaterialDescription> read_materials(TomlTable& top, NameIndex& names);

/// Throws InputError for names that are not known and files that cannot be used.
Material make_material(const MaterialDescription& material, const MaterialMaker& maker);

/// What light loses inside, 1/mm; nothing where it loses none.
std::optional<spectral::GridSpectrum> absorption(const MaterialDescription& material, SceneSpectra& spectra);

/// The files that a material is made of.
std::vector<std::filesystem::path> named_files(const MaterialDescription& material);

}  // namespace lensproof::scene
