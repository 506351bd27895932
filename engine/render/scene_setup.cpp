#include "engine/render/scene_setup.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/scene/chart/chart_file.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/spectra/spectrum_keys.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::render {

namespace {

void read_scene_tables(TomlTable& top, SceneSetup& setup) {
    TomlTable camera = top.table("camera");
    setup.camera = read_placed_camera(camera);
    setup.scene = scene::read_scene(top);
    const bool may_emit = std::ranges::any_of(setup.scene.objects, [](const scene::ObjectDescription& object) {
        const auto* mesh = std::get_if<scene::MeshFromFile>(&object.shape);
        return mesh != nullptr && mesh->options.by_material;  // whose materials may: it is known when they are read
    });
    if (setup.scene.lights.empty() && !may_emit) {
        top.fail("lights", "there is no light, expected [[lights]]");
    }
}

void read_chart_tables(TomlTable& top, SceneSetup& setup) {
    TomlTable camera = top.table("camera");
    setup.camera = read_camera_settings(camera);
    TomlTable chart = top.table("chart");
    setup.chart = ChartView{.chart = scene::read_chart(chart), .placement = {}};
    if (!std::holds_alternative<scene::FlatField>(setup.chart->chart.pattern)) {
        TomlTable pose = top.table("pose");
        setup.chart->placement = scene::read_placement(pose);
    }
    if (auto light = top.optional_table("light")) {
        read_even_light(*light, setup);
    }
}

}  // namespace

void read_even_light(TomlTable& table, SceneSetup& setup) {
    setup.camera.white_balance = scene::read_illuminant(table, "illuminant");
    setup.chart->luminance_cd_m2 = table.number_or("luminance_cd_m2", setup.chart->luminance_cd_m2, kPositive);
    table.finish();
}

void read_render_table(TomlTable& table, SceneSetup& setup) {
    setup.samples_per_pixel = table.integer_or("samples_per_pixel", setup.samples_per_pixel, 1, kMostSamplesPerPixel);
    if (!setup.chart) {
        setup.max_bounces = table.integer_or("max_bounces", setup.max_bounces, 0, 10000);
        setup.diffraction.smallest_airy =
            table.number_or("diffracted_from_airy", setup.diffraction.smallest_airy, {.min = 1.0, .max = 1000.0});
        if (table.has("precision")) {
            setup.scene.precision = scene::hit_precision_named(table.choice("precision", scene::hit_precision_names()));
        }
    }
    read_spectral_sampling(table, setup.spectral);
    const int wavelengths = setup.spectral.strata();
    if (!setup.chart && wavelengths % spectral::kWavelengthsPerPath != 0) {
        table.fail("layers", fmt::format("{} layers of {} strata are {} wavelengths, expected a multiple of {}",
                                         setup.spectral.layers, setup.spectral.strata_per_layer, wavelengths,
                                         spectral::kWavelengthsPerPath));
    }
    table.finish();
}

SceneSetup read_scene_setup(TomlTable top) {
    SceneSetup setup;
    top.has("chart") ? read_chart_tables(top, setup) : read_scene_tables(top, setup);
    if (auto render = top.optional_table("render")) {
        read_render_table(*render, setup);
    }
    if (auto sensor = top.optional_table("sensor")) {
        setup.sensor = read_raw_sensor(*sensor, {.response = setup.camera.response,
                                                 .exposure = setup.camera.exposure,
                                                 .white = setup.camera.white_balance,
                                                 .width = setup.camera.sensor.width,
                                                 .height = setup.camera.sensor.height});
    }
    top.finish();
    return setup;
}

SceneSetup parse_scene_setup(const std::string& text, const std::filesystem::path& name) {
    return read_scene_setup(TomlTable::parse(text, name));
}

SceneSetup coarser(SceneSetup setup, int shrinks, int fewer) {
    Sensor& sensor = setup.camera.sensor;
    const double width_mm = sensor.width * sensor.pixel_pitch_mm;
    const int whole_width = sensor.width;
    sensor.width = std::max(1, sensor.width / shrinks);
    sensor.height = std::max(1, sensor.height / shrinks);
    sensor.pixel_pitch_mm = width_mm / sensor.width;
    sensor.axis_from_middle_px = static_cast<double>(sensor.width) / whole_width * sensor.axis_from_middle_px;
    setup.samples_per_pixel = std::max(1, setup.samples_per_pixel / fewer);
    if (setup.stray_camera) {
        setup.stray_camera->sensor = sensor;
    }
    return setup;
}

SceneSetup read_scene_setup(const std::filesystem::path& file) {
    return read_scene_setup(TomlTable::read(file));
}

}  // namespace lensproof::render
