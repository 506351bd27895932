// engine/scene/scene_file_parts.h — the readers that a scene file's reader is made of.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "engine/base/toml.h"
#include "engine/scene/scene_description.h"

namespace lensproof::scene {

/// Names of one sort and their indices.
class NameIndex {
  public:
    /// `what` says what is named: "material".
    explicit NameIndex(std::string what) : what_(std::move(what)) {}

    /// Adds the name that `table` states under `key`, and returns it; an empty one only if `may_be_empty`.
    std::string add(TomlTable& table, const std::string& key, std::size_t index, bool may_be_empty);
    /// The index of the name under `key`.
    [[nodiscard]] std::size_t find(TomlTable& table, const std::string& key) const;
    /// The same for a name that was read already.
    [[nodiscard]] std::size_t find(const TomlTable& table, const std::string& key, const std::string& name) const;

  private:
    std::string what_;
    std::map<std::string, std::size_t> index_;
};

Vec3d read_vector(TomlTable& table, const std::string& key);
/// A vector that is not 0, made one of unit length.
Vec3d read_direction(TomlTable& table, const std::string& key);

/// A file beside the scene file, which has to be there.
std::filesystem::path read_file_name(TomlTable& table, const std::string& key);

/// A number within `bounds`, [r, g, b] within them, a name, a name of a CSV file, or { file = "…", column = "…" }.
/// `column` is that of a CSV file which is named alone.
SpectrumDescription read_spectrum(TomlTable& table, const std::string& key, const Bounds& bounds,
                                  const std::string& column);
/// The same, or { image = "…", scale = 1, repeats = [1, 1] }.
TextureDescription read_texture(TomlTable& table, const std::string& key, const Bounds& bounds,
                                const std::string& column);

std::vector<MaterialDescription> read_materials(TomlTable& top, NameIndex& names);
/// translate_mm, rotate_deg and scale, or matrix.
AffineMap read_transform(TomlTable& table);
std::vector<ObjectDescription> read_objects(TomlTable& top, const NameIndex& materials, NameIndex& names);
std::vector<LightDescription> read_lights(TomlTable& top, const NameIndex& objects);

}  // namespace lensproof::scene
