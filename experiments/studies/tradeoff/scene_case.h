// experiments/studies/tradeoff/scene_case.h — a scene with something in it changed, as an experiment's file states it.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/toml.h"
#include "engine/render/scene_setup.h"

namespace lensproof::studies {

struct SceneCase {
    std::string name;
    std::string stated;  // the whole scene, as both files state it
    render::SceneSetup setup;
    std::vector<std::filesystem::path> files;
};

/// The scene of `file` as it is.
SceneCase scene_case(const TomlTable& scene, const std::filesystem::path& file);

/// { name, scene = { … } }, which is put over the scene key by key.
SceneCase read_scene_case(TomlTable& table, const TomlTable& scene, const std::filesystem::path& file);

}  // namespace lensproof::studies
