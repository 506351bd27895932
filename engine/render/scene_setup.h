// engine/render/scene_setup.h — a whole scene file: the camera and how finely it looks, and what it looks at.
#pragma once
#include <filesystem>
#include <string>

#include "engine/render/camera.h"
#include "engine/render/raw_sensor.h"
#include "engine/scene/scene_description.h"

namespace lensproof::render {

struct SceneSetup {
    Camera camera;  // without a lens where the view says a focal length
    scene::CameraView view;
    std::string white_balance = "D65";  // the illuminant in which a white surface is R = G = B
    scene::SceneDescription scene;
    SpectralSampling spectral;
    int samples_per_pixel = 64;
    std::optional<RawSensor> sensor;  // the electronics behind the film, where a raw file is wanted
    int max_bounces = 16;             // scatterings on a path between camera and light; 0: lights alone are seen
};

/// Reads a scene file, as engine/scene/README.md documents it: [camera], [[materials]], [[objects]], [[lights]],
/// [render] and [sensor]. Illuminants and the files that it names have to be there; lens, meshes, pictures, tables,
/// metals and glasses are looked up by whoever builds the scene. Throws InputError naming file, line and key; besides
/// what `read_scene` and `read_camera` refuse, a scene without a light, and a number of wavelengths that is no multiple
/// of 4.
SceneSetup read_scene_setup(const std::filesystem::path& file);

/// The same from a text; `name` stands for the file in messages, and its folder is where files are looked for.
SceneSetup parse_scene_setup(const std::string& text, const std::filesystem::path& name);

}  // namespace lensproof::render
