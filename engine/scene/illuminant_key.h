// engine/scene/illuminant_key.h — illuminants as files name them.
#pragma once
#include <string>

#include "engine/base/toml.h"

namespace lensproof::scene {

/// The name of an illuminant that is known; D65 where the key is absent. Throws InputError naming file, line and key.
std::string read_illuminant(TomlTable& table, const std::string& key);

}  // namespace lensproof::scene
