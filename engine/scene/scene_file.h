// engine/scene/scene_file.h — the objects, materials and lights of a scene file.
#pragma once
#include "engine/base/toml.h"
#include "engine/scene/scene_description.h"

namespace lensproof::scene {

/// Reads [[materials]], [[objects]] and [[lights]], as README.md documents them. Files that they name are taken from
/// the scene file's folder, and have to be there; they are not read. Throws InputError naming file, line and key: a key
/// that is not known or out of its bounds, a name that is used twice or not known (with the nearest one that is), a
/// file that is missing, a transform that flattens, a light without power. `top` is not finished.
SceneDescription read_scene(TomlTable& top);

}  // namespace lensproof::scene
