// engine/scene/scene_file_parts.h — the readers that a scene file's reader is made of.
#pragma once
#include <vector>

#include "engine/base/toml_keys.h"
#include "engine/scene/scene_description.h"

namespace lensproof::scene {

/// translate_mm, rotate_deg and scale, or matrix.
AffineMap read_transform(TomlTable& table);
std::vector<ObjectDescription> read_objects(TomlTable& top, const NameIndex& materials, NameIndex& names);

}  // namespace lensproof::scene
