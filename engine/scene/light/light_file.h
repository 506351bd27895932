// engine/scene/light/light_file.h — the lights of a scene file.
#pragma once
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "engine/scene/light/light.h"
#include "engine/scene/light/sphere_light.h"

namespace lensproof::scene {

/// The kinds, each in a file of its own, which has besides what it says
///
///     kNames               what files call it
///     read_keys            its keys
///     check_beside         what it cannot stand beside, where there is such
///     make_light           one of `LightSource`
using LightKind = std::variant<AreaLightDescription, SphereLightDescription, PointLightDescription,
                               SpotLightDescription, SunLightDescription, EnvironmentLightDescription>;

struct LightDescription {
    LightKind kind;
    std::string where;  // "scene.toml:12: lights[2]", for later complaints
};

/// Throws InputError naming file, line and key.
std::vector<LightDescription> read_lights(TomlTable& top, const NameIndex& objects);

/// Throws InputError for a file that cannot be used, and for a light that sends nothing within the grid.
LightSource make_light(const LightDescription& light, const LightMaker& maker);

/// The files that a light is made of.
std::vector<std::filesystem::path> named_files(const LightDescription& light);

}  // namespace lensproof::scene
