#include "experiments/studies/cameras/simulations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "calibration/detection/detect.h"
#include "calibration/self_test/self_test.h"
#include "engine/base/input_error.h"
#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/image/image_json.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/optics/paraxial.h"
#include "engine/render/film/film_image.h"
#include "engine/render/integrators/chart_tracer.h"
#include "engine/render/integrators/integrators.h"
#include "engine/render/progressive.h"
#include "engine/scene/chart/chart_file.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/findings/shown_picture.h"
#include "experiments/studies/cameras/lens_profile.h"

namespace lensproof::studies {

namespace {

ClosedLoopLimits read_limits(TomlTable& table) {
    const ClosedLoopLimits limits{.distortion_rms_px = table.optional_number("distortion_rms_px", kPositive),
                                  .distortion_largest_px = table.optional_number("distortion_largest_px", kPositive),
                                  .vignetting_percent = table.optional_number("vignetting_percent", kPositive),
                                  .chromatic_shift_px = table.optional_number("chromatic_shift_px", kPositive)};
    table.finish();
    return limits;
}

Simulation read_simulation(TomlTable& table, findings::ExperimentFile& file) {
    Simulation simulation;
    simulation.name = read_camera_name(table, file);
    simulation.model = read_model(table);
    simulation.flat_field = table.boolean_or("flat_field", true);
    simulation.flat_field_samples_per_pixel =
        table.integer_or("flat_field_samples_per_pixel", simulation.flat_field_samples_per_pixel, 1, 1 << 20);
    TomlTable camera = table.table("camera");
    simulation.scene.camera = render::read_camera_settings(camera);
    try {
        render::camera_lens(simulation.scene.camera);
    } catch (const InputError& error) {
        table.fail("camera", error.what());
    }
    TomlTable chart = table.table("chart");
    simulation.scene.chart = render::ChartView{.chart = scene::read_chart(chart), .placement = {}};
    const scene::Chart& seen = simulation.scene.chart->chart;
    if (std::holds_alternative<scene::FlatField>(seen.pattern)) {
        chart.fail("kind", "is a flat field, expected a chart with points; the flat field is rendered besides");
    }
    if (!calibration::can_detect(seen)) {
        chart.fail("kind", fmt::format("is {}, which is not measured: expected one of {}", scene::kind_name(seen),
                                       calibration::detectable_kinds()));
    }
    simulation.stated_scene = {{"camera", camera.stated()}, {"chart", chart.stated()}};
    if (auto light = file.top.optional_table("light")) {
        render::read_even_light(*light, simulation.scene);
        simulation.stated_scene["light"] = light->stated();
    }
    if (auto render = file.top.optional_table("render")) {
        render::read_render_table(*render, simulation.scene);
        simulation.stated_scene["render"] = render->stated();
    }
    if (auto own = table.optional_table("render")) {
        render::read_render_table(*own, simulation.scene);
        simulation.stated_scene["own_render"] = own->stated();
    }
    for (TomlTable& view : table.tables("views")) {
        simulation.views.push_back(scene::read_placement(view));
        simulation.stated_views.push_back(view.stated());
    }
    if (simulation.views.empty()) {
        table.fail("views", "holds no view of the chart");
    }
    if (auto limits = table.optional_table("limits")) {
        simulation.limits = read_limits(*limits);
    }
    table.finish();
    return simulation;
}

/// The picture's colours (or grey) alone.
formats::Image colours_only(const formats::Image& image) {
    std::vector<std::string> kept;
    for (const char* name : {"R", "G", "B"}) {
        if (formats::find_channel(image, name) >= 0) {
            kept.emplace_back(name);
        }
    }
    if (kept.empty()) {
        kept = {image.channels.front()};
    }
    formats::Image colours = formats::make_image(image.width, image.height, kept);
    for (int c = 0; c < colours.channel_count(); ++c) {
        const int from = formats::find_channel(image, kept[c]);
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                colours.at(x, y, c) = image.at(x, y, from);
            }
        }
    }
    return colours;
}

std::string describe(const scene::Placement& placement) {
    std::string text = fmt::format("chart at {:g} m", placement.distance_mm / 1000.0);
    if (placement.towards_right_deg != 0.0 || placement.towards_down_deg != 0.0) {
        text += fmt::format(", {:g}° right and {:g}° down", placement.towards_right_deg, placement.towards_down_deg);
    }
    const auto& tilt = placement.tilt_deg;
    if (tilt[0] != 0.0 || tilt[1] != 0.0 || tilt[2] != 0.0) {
        text += fmt::format(", tilted {:g}°, {:g}°, {:g}°", tilt[0], tilt[1], tilt[2]);
    }
    return text;
}

void add_facts(MeasuredCamera& measured, const Simulation& simulation, const render::Camera& simulated) {
    const render::CameraSettings& camera = simulation.scene.camera;
    const optics::Lens& lens = *simulated.lens();
    const optics::ParaxialData data = optics::paraxial_data(optics::at_wavelength<double>(lens, spectral::kLineD));
    measured.subject.facts = {
        {"prescription", lens.source},
        {"effective focal length (d)", fmt::format("{:.4f} mm", data.efl)},
        {"f-number", fmt::format("f/{:g}", camera.f_number)},
        {"focused at", std::isinf(camera.focus_distance_mm) ? std::string("infinity")
                                                            : fmt::format("{:g} m", camera.focus_distance_mm / 1e3)},
        {"sensor", fmt::format("{} × {} px of {:g} µm", camera.sensor.width, camera.sensor.height,
                               1e3 * camera.sensor.pixel_pitch_mm)},
        {"sensor response, light", camera.response + ", " + camera.white_balance}};
    add_profile_facts(measured);
    if (!simulated.clamp_note().empty()) {
        measured.subject.facts.push_back({"note", simulated.clamp_note()});
    }
}

}  // namespace

std::vector<Simulation> simulations_of(findings::ExperimentFile& file) {
    std::vector<Simulation> simulations;
    for (TomlTable& table : file.top.tables("simulations")) {
        simulations.push_back(read_simulation(table, file));
    }
    // Without a simulation that reads them, they would be refused as unknown keys.
    if (file.top.has("photos")) {
        file.top.optional_table("light");
        file.top.optional_table("render");
    }
    return simulations;
}

MeasuredCamera measure_simulation(const Simulation& simulation, const render::Camera& camera,
                                  const findings::RunSettings& settings, const findings::RunProgress& progress) {
    MeasuredCamera measured{.subject = {.id = simulation.name, .kind = "simulation", .label = camera.lens()->name},
                            .profile = {},
                            .traced = {}};
    const std::vector<std::filesystem::path> files = formats::files_of_lens(simulation.scene.camera.lens);
    const auto input_of = [&](Json what) {
        return findings::StepInput{
            .settings = {{"scene", simulation.stated_scene}, {"what", std::move(what)}, {"seed", settings.seed}},
            .files = files};
    };
    std::vector<calibration::Picture> pictures;
    const auto add_picture = [&](const std::string& file, const std::string& caption, calibration::PictureRole role,
                                 const scene::Chart& chart, const scene::Placement& placement, int samples_per_pixel,
                                 const std::string& step, Json stated) {
        const auto rendered = [&] {
            const render::World world =
                render::even_chart(chart, placement, simulation.scene.chart->luminance_cd_m2, camera);
            const render::View view{.world = &world,
                                    .camera = &camera,
                                    .seed = settings.seed + pictures.size()};  // views do not share their noise
            const render::Film film =
                render::render_film(render::integrator_named("chart").render(view),
                                    {.first = 0, .end = static_cast<std::uint32_t>(samples_per_pixel)},
                                    settings.threads, [&](double done) { progress(simulation.name + step, done); });
            return colours_only(render::film_image(film));
        };
        formats::Image image = settings.steps.step(
            "view", input_of(Json::list({std::move(stated), samples_per_pixel, pictures.size()})), rendered);
        const std::string name = fmt::format("{}/{}.png", simulation.name, file);
        measured.subject.pictures.push_back(findings::shown_picture(name, caption, image));
        pictures.push_back({.name = name, .role = role, .load = [image = std::move(image)] { return image; }});
    };
    const std::size_t count = simulation.views.size();
    for (std::size_t i = 0; i < count; ++i) {
        add_picture(fmt::format("view-{}", i + 1), describe(simulation.views[i]), calibration::PictureRole::chart,
                    simulation.scene.chart->chart, simulation.views[i], simulation.scene.samples_per_pixel,
                    fmt::format(", view {} of {}", i + 1, count), simulation.stated_views[i]);
    }
    if (simulation.flat_field) {
        add_picture("flat-field", "flat field", calibration::PictureRole::flat_field, {.pattern = scene::FlatField{}},
                    {.distance_mm = 1000.0}, simulation.flat_field_samples_per_pixel, ", flat field", "flat field");
    }
    progress(simulation.name + ", measuring", 0.0);
    const calibration::MeasureInput input{
        .name = simulation.name,
        .pictures = std::move(pictures),
        .chart = simulation.scene.chart->chart,
        .model = simulation.model,
        .geometry = {.fit_tangential = false},  // a centred lens
        .source = {.kind = "render", .images = {}, .camera = "simulated", .lens = measured.subject.label},
        .pixel_pitch_um = 1e3 * camera.sensor().pixel_pitch_mm,
        .threads = settings.threads};
    const findings::StepInput all =
        input_of({{"name", simulation.name},
                  {"model", stated_model(simulation.model)},
                  {"views", simulation.stated_views},
                  {"flat_field", simulation.flat_field ? simulation.flat_field_samples_per_pixel : 0},
                  {"samples_per_pixel", simulation.scene.samples_per_pixel}});
    measured.profile = measured_in_steps(settings, all, input, calibration::measure);
    measured.far_points = far_points(measured.profile, input.pictures);
    for (std::size_t i = 0; i < count; ++i) {
        add_view(measured.subject.pictures[i], measured.profile.views.at(i));
    }
    progress(simulation.name + ", tracing", 0.0);
    measured.traced = settings.steps.step("traced", input_of("traced"), [&] { return lens_profile(camera); });
    add_facts(measured, simulation, camera);
    return measured;
}

static findings::Findings simulation_findings(const Simulation& simulation, const findings::RunSettings& settings,
                                              const findings::RunProgress& progress) {
    const render::Camera camera(simulation.scene.camera, simulation.scene.spectral, render::PixelFilter{},
                                settings.cache);
    MeasuredCamera measured = measure_simulation(simulation, camera, settings, progress);
    std::vector<findings::Check> checks = closed_loop_checks(measured.subject.id, measured.subject.label,
                                                             measured.profile, *measured.traced, simulation.limits);
    findings::Findings found = camera_findings(std::move(measured), simulation.limits);
    findings::append(found, {.checks = std::move(checks)});
    found.inputs = formats::shipped_glass_files();
    std::ranges::move(formats::shipped_transmittance_files(), std::back_inserter(found.inputs));
    found.inputs.push_back(formats::find_lens_file(simulation.scene.camera.lens));
    return found;
}

std::vector<findings::Study> read_simulations(findings::ExperimentFile& file) {
    std::vector<findings::Study> studies;
    for (Simulation& simulation : simulations_of(file)) {
        std::string name = simulation.name;
        studies.push_back({std::move(name), [simulation = std::move(simulation)](const findings::RunSettings& settings,
                                                                                 const findings::RunProgress& progress,
                                                                                 const findings::Findings&) {
                               return simulation_findings(simulation, settings, progress);
                           }});
    }
    return studies;
}

}  // namespace lensproof::studies
