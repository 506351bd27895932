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
#include "engine/render/scene_setup.h"
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
    simulation.parts = read_parts(table);
    simulation.references = read_references(table);
    simulation.flat_field = table.boolean_or("flat_field", simulation.parts.vignetting);
    simulation.flat_field_samples_per_pixel = table.integer_or(
        "flat_field_samples_per_pixel", simulation.flat_field_samples_per_pixel, 1, render::kMostSamplesPerPixel);
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
    for (TomlTable& table : file.tables("simulations")) {
        simulations.push_back(read_simulation(table, file));
    }
    // Without a simulation that reads them, they would be refused as unknown keys.
    if (file.top.has("photos")) {
        file.top.optional_table("light");
        file.top.optional_table("render");
    }
    return simulations;
}

namespace {

constexpr const char* kViewStep = "view";
constexpr const char* kTracedStep = "traced";

/// One of the pictures that a simulation takes.
struct SimulatedPicture {
    std::string file;
    std::string caption;
    std::string words;  // of progress
    calibration::PictureRole role = calibration::PictureRole::chart;
    scene::Chart chart;
    scene::Placement placement;
    int samples_per_pixel = 0;
    Json stated;
};

std::vector<SimulatedPicture> pictures_of(const Simulation& simulation) {
    std::vector<SimulatedPicture> pictures;
    const std::size_t count = simulation.views.size();
    for (std::size_t i = 0; i < count; ++i) {
        pictures.push_back({.file = fmt::format("view-{}", i + 1),
                            .caption = describe(simulation.views[i]),
                            .words = fmt::format("view {} of {}", i + 1, count),
                            .role = calibration::PictureRole::chart,
                            .chart = simulation.scene.chart->chart,
                            .placement = simulation.views[i],
                            .samples_per_pixel = simulation.scene.samples_per_pixel,
                            .stated = simulation.stated_views[i]});
    }
    if (simulation.flat_field) {
        pictures.push_back({.file = "flat-field",
                            .caption = "flat field",
                            .words = "flat field",
                            .role = calibration::PictureRole::flat_field,
                            .chart = {.pattern = scene::FlatField{}},
                            .placement = {.distance_mm = 1000.0},
                            .samples_per_pixel = simulation.flat_field_samples_per_pixel,
                            .stated = "flat field"});
    }
    return pictures;
}

findings::StepInput input_of(const Simulation& simulation, const findings::RunSettings& settings, Json what) {
    return {.settings = {{"scene", simulation.stated_scene}, {"what", std::move(what)}, {"seed", settings.seed}},
            .files = formats::files_of_lens(simulation.scene.camera.lens)};
}

/// `index`: of all pictures; views do not share their noise.
findings::StepInput view_input(const Simulation& simulation, const findings::RunSettings& settings,
                               const SimulatedPicture& picture, std::size_t index) {
    return input_of(simulation, settings, Json::list({picture.stated, picture.samples_per_pixel, index}));
}

/// Of all that is measured in the pictures.
findings::StepInput measured_input(const Simulation& simulation, const findings::RunSettings& settings) {
    return input_of(simulation, settings,
                    {{"name", simulation.name},
                     {"model", stated_model(simulation.model)},
                     {"only", stated_parts(simulation.parts)},
                     {"views", simulation.stated_views},
                     {"flat_field", simulation.flat_field ? simulation.flat_field_samples_per_pixel : 0},
                     {"samples_per_pixel", simulation.scene.samples_per_pixel}});
}

render::Camera camera_of(const Simulation& simulation, const findings::RunSettings& settings) {
    return {simulation.scene.camera, simulation.scene.spectral, render::PixelFilter{}, settings.cache, false,
            settings.device};
}

formats::Image rendered(const Simulation& simulation, const render::Camera& camera, const SimulatedPicture& picture,
                        std::size_t index, const findings::RunSettings& settings,
                        const findings::RunProgress& progress) {
    return settings.steps.step(kViewStep, view_input(simulation, settings, picture, index), [&] {
        const render::World world =
            render::even_chart(picture.chart, picture.placement, simulation.scene.chart->luminance_cd_m2, camera);
        const render::View view{.world = &world, .camera = &camera, .seed = settings.seed + index};
        const std::string words = fmt::format("{}, {}", simulation.name, picture.words);
        const render::Film film =
            render::render_film(render::integrator_named("chart").render(view),
                                {.first = 0, .end = static_cast<std::uint32_t>(picture.samples_per_pixel)},
                                settings.threads, [&](double done) { progress(words, done); });
        return colours_only(render::film_image(film));
    });
}

std::vector<findings::PlannedStep> steps_of(const Simulation& simulation, const findings::RunSettings& settings) {
    std::vector<findings::PlannedStep> steps;
    const render::Sensor& sensor = simulation.scene.camera.sensor;
    const double pixels = static_cast<double>(sensor.width) * sensor.height;
    const std::vector<SimulatedPicture> pictures = pictures_of(simulation);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        constexpr double kSecondsOfSample = 5e-7;
        const auto carry_out = [&simulation, picture = pictures[i], i](const findings::RunSettings& run,
                                                                       const findings::RunProgress& progress) {
            static_cast<void>(rendered(simulation, camera_of(simulation, run), picture, i, run, progress));
        };
        steps.push_back({kViewStep, fmt::format("{}, {}", simulation.name, pictures[i].words),
                         view_input(simulation, settings, pictures[i], i),
                         kSecondsOfSample * pixels * pictures[i].samples_per_pixel, carry_out});
    }
    std::ranges::move(steps_of_measurement(simulation.name, measured_input(simulation, settings), settings),
                      std::back_inserter(steps));
    steps.push_back({kTracedStep, simulation.name + ", tracing", input_of(simulation, settings, kTracedStep)});
    return steps;
}

}  // namespace

MeasuredCamera measure_simulation(const Simulation& simulation, const render::Camera& camera,
                                  const findings::RunSettings& settings, const findings::RunProgress& progress) {
    MeasuredCamera measured{.subject = {.id = simulation.name, .kind = "simulation", .label = camera.lens()->name},
                            .profile = {},
                            .traced = {}};
    std::vector<calibration::Picture> pictures;
    for (const SimulatedPicture& picture : pictures_of(simulation)) {
        formats::Image image = rendered(simulation, camera, picture, pictures.size(), settings, progress);
        const std::string name = fmt::format("{}/{}.png", simulation.name, picture.file);
        measured.subject.pictures.push_back(findings::shown_picture(name, picture.caption, image));
        pictures.push_back({.name = name, .role = picture.role, .load = [image = std::move(image)] { return image; }});
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
        .parts = simulation.parts,
        .threads = settings.threads};
    measured.profile = measured_in_steps(settings, measured_input(simulation, settings), input, calibration::measure);
    measured.far_points = far_points(measured.profile, input.pictures);
    for (std::size_t i = 0; i < simulation.views.size(); ++i) {
        add_view(measured.subject.pictures[i], measured.profile.views.at(i));
    }
    progress(simulation.name + ", tracing", 0.0);
    measured.traced = settings.steps.step(kTracedStep, input_of(simulation, settings, kTracedStep),
                                          [&] { return lens_profile(camera); });
    add_references(simulation.references, measured, simulation.scene.camera.f_number);
    add_facts(measured, simulation, camera);
    return measured;
}

static findings::Findings simulation_findings(const Simulation& simulation, const findings::RunSettings& settings,
                                              const findings::RunProgress& progress) {
    MeasuredCamera measured = measure_simulation(simulation, camera_of(simulation, settings), settings, progress);
    std::vector<findings::Check> checks = closed_loop_checks(measured.subject.id, measured.subject.label,
                                                             measured.profile, *measured.traced, simulation.limits);
    findings::Findings found = camera_findings(std::move(measured), simulation.limits);
    findings::append(found, {.checks = std::move(checks)});
    found.not_shown = {
        "A render is of the lens as its prescription states it: no tolerances of manufacture, no dust, no filters of "
        "the "
        "sensor.",
        "Views of a simulation are lit evenly; a chart's own shadows and gloss are not in them."};
    found.inputs = formats::shipped_glass_files();
    std::ranges::move(formats::shipped_transmittance_files(), std::back_inserter(found.inputs));
    found.inputs.push_back(formats::find_lens_file(simulation.scene.camera.lens));
    std::ranges::move(files_of(simulation.references), std::back_inserter(found.inputs));
    return found;
}

std::vector<findings::Study> read_simulations(findings::ExperimentFile& file) {
    std::vector<findings::Study> studies;
    for (const Simulation& simulation : simulations_of(file)) {
        studies.push_back(
            {simulation.name,
             [simulation](const findings::RunSettings& settings, const findings::RunProgress& progress,
                          const findings::Findings&) { return simulation_findings(simulation, settings, progress); },
             [simulation](const findings::RunSettings& settings) { return steps_of(simulation, settings); }});
    }
    return studies;
}

}  // namespace lensproof::studies
