// engine/base/toml_keys.h — places, files and names as TOML files state them.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "engine/base/toml.h"
#include "engine/base/vec.h"

namespace lensproof {

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

/// A file beside the table's own, which has to be there: the one that `key` names, or whose name was read already.
std::filesystem::path read_file_name(TomlTable& table, const std::string& key);
std::filesystem::path file_beside(const TomlTable& table, const std::string& key, const std::string& name);

}  // namespace lensproof
