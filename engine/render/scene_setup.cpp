#include "engine/render/scene_setup.h"

#include <fmt/format.h>

#include "engine/base/file.h"
#include "engine/scene/illuminant_key.h"
#include "engine/scene/scene_file.h"

namespace lensproof::render {

namespace {

constexpr int kWavelengthsAtOnce = 4;  // that a path carries

void read_render(TomlTable& table, SceneSetup& setup) {
    setup.samples_per_pixel = table.integer_or("samples_per_pixel", setup.samples_per_pixel, 1, 1 << 20);
    setup.max_bounces = table.integer_or("max_bounces", setup.max_bounces, 0, 10000);
    read_spectral_sampling(table, setup.spectral);
    const int count = setup.spectral.layers * setup.spectral.strata_per_layer;
    if (count % kWavelengthsAtOnce != 0) {
        table.fail("layers",
                   fmt::format("{} layers of {} strata are {} wavelengths, expected a multiple of {}",
                               setup.spectral.layers, setup.spectral.strata_per_layer, count, kWavelengthsAtOnce));
    }
    table.finish();
}

}  // namespace

SceneSetup parse_scene_setup(const std::string& text, const std::filesystem::path& name) {
    TomlTable top = TomlTable::parse(text, name);
    SceneSetup setup;
    TomlTable camera = top.table("camera");
    setup.view = scene::read_camera_view(camera);
    setup.camera = read_camera_keys(camera, setup.view.focal_length_mm.has_value());
    setup.white_balance = scene::read_illuminant(camera, "white_balance");
    if (setup.view.focal_length_mm && !setup.camera.lens.empty()) {
        camera.fail("focal_length_mm", "stands beside lens, expected one or the other");
    }
    if (setup.camera.blades && setup.view.model != scene::LensModel::exact) {
        camera.fail("blades",
                    fmt::format("stands beside model = \"{}\", whose pupil is round; expected the exact model",
                                scene::name_of(setup.view.model)));
    }
    camera.finish();
    setup.scene = scene::read_scene(top);
    if (setup.scene.lights.empty()) {
        top.fail("lights", "there is no light, expected [[lights]]");
    }
    if (auto render = top.optional_table("render")) {
        read_render(*render, setup);
    }
    if (auto sensor = top.optional_table("sensor")) {
        setup.sensor = read_raw_sensor(*sensor, {.response = setup.camera.response,
                                                 .exposure = setup.camera.exposure,
                                                 .white = setup.white_balance,
                                                 .width = setup.camera.sensor.width,
                                                 .height = setup.camera.sensor.height});
    }
    top.finish();
    return setup;
}

SceneSetup read_scene_setup(const std::filesystem::path& file) {
    return parse_scene_setup(read_file(file), file);
}

}  // namespace lensproof::render
