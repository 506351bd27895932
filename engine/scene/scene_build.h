// engine/scene/scene_build.h — from what a scene file says to what light meets.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/cache.h"
#include "engine/scene/scene.h"
#include "engine/scene/scene_description.h"

namespace lensproof::scene {

/// A scene, where the scene file states each of its lights (or which mesh's file does), and what was repaired or left
/// out on the way to it, a sentence each.
struct BuiltScene {
    Scene scene;
    std::vector<std::string> light_places;
    std::vector<std::string> remarks;
};

/// Reads the meshes, pictures and tables that `description` names, looks up its spectra, metals and glasses, and
/// tabulates all on `grid`. `cache`: for the uplift of RGB. Throws InputError naming the place in the scene file and
/// what is wrong with what it names: a file that cannot be used, a name that is not known, an index of 0, a glass that
/// does not cover the grid, a light that sends nothing within it.
BuiltScene build_scene(const SceneDescription& description, const spectral::SpectralGrid& grid, const Cache& cache);

/// The files that it reads, each once: what a scene's identity depends on besides its own text.
std::vector<std::filesystem::path> named_files(const SceneDescription& description);

}  // namespace lensproof::scene
