// engine/scene/scene_file.h — the objects, materials and lights of a scene file, and where its camera stands.
#pragma once
#include "engine/base/toml.h"
#include "engine/scene/scene_description.h"

namespace lensproof::scene {

/// Reads [[materials]], [[objects]] and [[lights]], as README.md documents them. Files that they name are taken from
/// the scene file's folder, and have to be there; they are not read. Throws InputError naming file, line and key: a key
/// that is not known or out of its bounds, a name that is used twice or not known (with the nearest one that is), a
/// file that is missing, a transform that flattens, a light without power. `top` is not finished.
SceneDescription read_scene(TomlTable& top);

/// Reads position_mm, look_at_mm, up, model and focal_length_mm of a camera's table, and leaves its other keys.
CameraView read_camera_view(TomlTable& camera);

}  // namespace lensproof::scene
