// engine/render/scene_setup.h — a whole scene file: the camera and how finely it looks, and what it looks at.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "engine/render/camera/camera_settings.h"
#include "engine/render/raw/raw_sensor.h"
#include "engine/render/stray/diffraction_settings.h"
#include "engine/scene/scene_description.h"

namespace lensproof::render {

/// A chart in an even world, lit by the light that the camera is balanced to.
struct ChartView {
    scene::Chart chart;
    scene::Placement placement;       // before the camera
    double luminance_cd_m2 = 1000.0;  // of a perfect white
};

struct SceneSetup {
    CameraSettings camera;
    /// In whose lens light goes astray, where `camera` is a simpler model of it; none: `camera`'s own, traced exactly.
    /// Its sensor is `camera`'s.
    std::optional<CameraSettings> stray_camera;
    scene::SceneDescription scene;
    std::optional<ChartView> chart;  // in the place of the scene
    SpectralSampling spectral;
    int samples_per_pixel = 64;
    std::optional<RawSensor> sensor;  // the electronics behind the film, where a raw file is wanted
    int max_bounces = 16;             // scatterings on a path between camera and light; 0: lights alone are seen
    DiffractionSettings diffraction;
};

inline constexpr int kMostSamplesPerPixel = 1 << 20;

/// Reads a scene file, as engine/scene/README.md documents it: [camera], [[materials]], [[objects]], [[lights]],
/// [render] and [sensor]. Illuminants and the files that it names have to be there; lens, meshes, pictures, tables,
/// metals and glasses are looked up by whoever builds the scene. Throws InputError naming file, line and key; besides
/// what `read_scene` and `read_placed_camera` refuse, a scene without a light, and a number of wavelengths that is no
/// multiple of 4.
///
/// With a table [chart] it is a chart's: [camera] without a place, [chart], [pose], [light] (illuminant,
/// luminance_cd_m2), [render] (without max_bounces) and [sensor]; all but [camera] and [chart] are optional, [pose] for
/// a flat field alone.
SceneSetup read_scene_setup(const std::filesystem::path& file);

/// The same of a table that holds all of it.
SceneSetup read_scene_setup(TomlTable top);

/// The same from a text; `name` stands for the file in messages, and its folder is where files are looked for.
SceneSetup parse_scene_setup(const std::string& text, const std::filesystem::path& name);

/// The same frame in pixels `shrinks` times as wide and as high, with one sample for `fewer`, one at least.
SceneSetup coarser(SceneSetup setup, int shrinks, int fewer);

/// Reads a chart's table [light], and a table [render] over what `setup` says.
void read_even_light(TomlTable& table, SceneSetup& setup);
void read_render_table(TomlTable& table, SceneSetup& setup);

}  // namespace lensproof::render
