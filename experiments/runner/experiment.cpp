#include "experiments/runner/experiment.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "calibration/detection/detect.h"
#include "engine/base/input_error.h"
#include "experiments/studies/stability/extremes.h"

namespace lensproof::runner {

namespace {

/// Curves that two subjects may have in common: calibration/profile/profile.h's, and positions in pixels.
const std::vector<std::string> kComparedCurves = {"radial_px",
                                                  "field_angle_deg",
                                                  "distortion_percent",
                                                  "distortion_equidistant_percent",
                                                  "vignetting_R",
                                                  "vignetting_G",
                                                  "vignetting_B",
                                                  "vignetting_Y",
                                                  "vignetting_R_ev",
                                                  "vignetting_G_ev",
                                                  "vignetting_B_ev",
                                                  "vignetting_Y_ev",
                                                  "chromatic_shift_R_px",
                                                  "chromatic_shift_B_px"};

std::optional<calibration::ModelKind> read_model(TomlTable& table) {
    if (!table.has("model")) {
        return std::nullopt;
    }
    std::vector<std::string> names = calibration::model_kind_names();
    names.emplace_back("auto");
    return calibration::model_kind(table.choice("model", names));
}

std::string read_name(TomlTable& table) {
    std::string name = table.text("name");
    // Names become files' names.
    const bool plain = std::ranges::all_of(
        name, [](unsigned char letter) { return std::isalnum(letter) != 0 || letter == '-' || letter == '_'; });
    if (name.empty() || !plain) {
        table.fail("name", fmt::format("is \"{}\", expected letters, digits, - and _", name));
    }
    return name;
}

ClosedLoopLimits read_limits(TomlTable& table) {
    const ClosedLoopLimits limits{.distortion_rms_px = table.optional_number("distortion_rms_px", kPositive),
                                  .distortion_largest_px = table.optional_number("distortion_largest_px", kPositive),
                                  .vignetting_percent = table.optional_number("vignetting_percent", kPositive),
                                  .chromatic_shift_px = table.optional_number("chromatic_shift_px", kPositive)};
    table.finish();
    return limits;
}

Simulation read_simulation(TomlTable& table, TomlTable& top) {
    Simulation simulation;
    simulation.name = read_name(table);
    simulation.model = read_model(table);
    simulation.flat_field = table.boolean_or("flat_field", true);
    simulation.flat_field_samples_per_pixel =
        table.integer_or("flat_field_samples_per_pixel", simulation.flat_field_samples_per_pixel, 1, 1 << 20);
    TomlTable camera = table.table("camera");
    simulation.scene.camera = render::read_camera(camera);
    try {
        render::camera_lens(simulation.scene.camera);
    } catch (const InputError& error) {
        table.fail("camera", error.what());
    }
    TomlTable chart = table.table("chart");
    simulation.scene.chart = scene::read_chart(chart);
    if (std::holds_alternative<scene::FlatField>(simulation.scene.chart.pattern)) {
        chart.fail("kind", "is a flat field, expected a chart with points; the flat field is rendered besides");
    }
    if (!calibration::can_detect(simulation.scene.chart)) {
        chart.fail("kind", fmt::format("is {}, which is not measured: expected one of {}",
                                       scene::kind_name(simulation.scene.chart), calibration::detectable_kinds()));
    }
    if (auto light = top.optional_table("light")) {
        simulation.scene.light = render::read_light(*light);
    }
    if (auto render = top.optional_table("render")) {
        render::read_render_table(*render, simulation.scene);
    }
    if (auto own = table.optional_table("render")) {
        render::read_render_table(*own, simulation.scene);
    }
    for (TomlTable& view : table.tables("views")) {
        simulation.views.push_back(scene::read_placement(view));
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

PhotoSubject read_photos(TomlTable& table) {
    PhotoSubject subject;
    subject.name = read_name(table);
    subject.manifest = table.file().parent_path() / table.text("manifest");
    subject.model = read_model(table);
    if (auto expected = table.optional_table("expected")) {
        if (expected->has("focal_length_px")) {
            subject.expected.focal_length_px = expected->number("focal_length_px", kPositive);
            subject.expected.focal_length_within_percent = expected->number("focal_length_within_percent", kPositive);
            subject.expected.focal_length_source = expected->text("focal_length_source");
        }
        subject.expected.reprojection_rms_px = expected->optional_number("reprojection_rms_px", kPositive);
        expected->finish();
    }
    table.finish();
    return subject;
}

Comparison read_comparison(TomlTable& table, const std::set<std::string>& subjects) {
    Comparison comparison;
    for (const auto& [key, name] : {std::pair{"of", &comparison.of}, std::pair{"with", &comparison.with}}) {
        *name = table.text(key);
        if (!subjects.contains(*name)) {
            table.fail(key,
                       fmt::format("is \"{}\", which is neither a simulation nor a photo set of this file", *name));
        }
    }
    comparison.curve = table.choice("curve", kComparedCurves);
    comparison.limit = table.optional_number("limit", kPositive);
    if (table.has("expect")) {
        comparison.expectation =
            table.choice("expect", {"agrees", "differs"}) == "agrees" ? Expectation::at_most : Expectation::differs;
    }
    table.finish();
    return comparison;
}

/// The names that the file lists under `key`, each of which is known; none where it does not.
std::vector<std::string> names_of(TomlTable& table, const char* key, const std::vector<std::string>& known) {
    std::vector<std::string> names = table.has(key) ? table.texts(key) : std::vector<std::string>{};
    for (const std::string& name : names) {
        if (std::ranges::find(known, name) == known.end()) {
            table.fail(key, fmt::format("names \"{}\", expected one of {}", name, fmt::join(known, ", ")));
        }
    }
    return names;
}

StabilityExperiment read_stability(TomlTable& table) {
    StabilityExperiment stability;
    std::vector<std::string> known;
    std::ranges::transform(studies::stability_extremes(), std::back_inserter(known), &studies::Extreme::id);
    stability.extremes = names_of(table, "extremes", known);
    table.finish();
    return stability;
}

PassageSetting read_passage(TomlTable& table) {
    constexpr Bounds kPercent{.min = 0.0, .max = 100.0};
    PassageSetting setting{
        .lens = table.text("lens"), .f_number = table.number("f_number", {.min = 0.1, .max = 1000.0}), .published = {}};
    if (auto published = table.optional_table("published_percent")) {
        setting.published =
            PassageSetting::Published{.whole_element_percent = published->number("whole_element", kPercent),
                                      .pupil_percent = published->number("pupil", kPercent)};
        published->finish();
    }
    table.finish();
    return setting;
}

studies::FloorSettings read_measurement_floor(TomlTable& table) {
    studies::FloorSettings settings;
    settings.sweeps = names_of(table, "sweeps", studies::detector_sweeps());
    settings.detectors = names_of(table, "detectors", studies::floor_detectors());
    settings.pictures = table.integer_or("pictures", settings.pictures, 1, 1000);
    settings.trials = table.integer_or("trials", settings.trials, 20, 100000);
    table.finish();
    return settings;
}

}  // namespace

Experiment read_experiment(const std::filesystem::path& file) {
    TomlTable top = TomlTable::read(file);
    Experiment experiment;
    experiment.file = file;
    experiment.title = top.text("title");
    experiment.summary = top.text_or("summary", "");
    if (auto stability = top.optional_table("stability")) {
        experiment.stability = read_stability(*stability);
        top.finish();
        return experiment;
    }
    for (TomlTable& table : top.tables("pupil_passage")) {
        experiment.pupil_passage.push_back(read_passage(table));
    }
    if (!experiment.pupil_passage.empty()) {
        top.finish();
        return experiment;
    }
    if (auto floor = top.optional_table("measurement_floor")) {
        experiment.measurement_floor = read_measurement_floor(*floor);
        top.finish();
        return experiment;
    }
    std::set<std::string> names;
    for (TomlTable& table : top.tables("simulations")) {
        experiment.simulations.push_back(read_simulation(table, top));
        if (!names.insert(experiment.simulations.back().name).second) {
            table.fail("name", "stands in the file twice");
        }
    }
    for (TomlTable& table : top.tables("photos")) {
        experiment.photos.push_back(read_photos(table));
        if (!names.insert(experiment.photos.back().name).second) {
            table.fail("name", "stands in the file twice");
        }
    }
    for (TomlTable& table : top.tables("comparisons")) {
        experiment.comparisons.push_back(read_comparison(table, names));
    }
    // Without a simulation that read them, they would be refused as unknown keys.
    top.optional_table("light");
    top.optional_table("render");
    top.finish();
    if (names.empty()) {
        top.fail("",
                 "holds neither [[simulations]] nor [[photos]] nor [stability] nor [[pupil_passage]] nor "
                 "[measurement_floor]");
    }
    return experiment;
}

}  // namespace lensproof::runner
