#include "experiments/studies/tradeoff/tradeoff_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/scene/scene_build.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"
#include "experiments/findings/shown_picture.h"

namespace lensproof::studies {

namespace {

constexpr std::size_t kRings = 8;  // of image heights, that curves have a sample each of

const RungError& error_named(const std::string& key) {
    return *std::ranges::find(rung_errors(), key, &RungError::key);
}

std::vector<std::string> error_keys() {
    std::vector<std::string> keys;
    std::ranges::transform(rung_errors(), std::back_inserter(keys), &RungError::key);
    return keys;
}

TradeoffCheck read_check(TomlTable& table, const TradeoffScene& scene) {
    std::vector<std::string> names;
    std::ranges::transform(scene.rungs, std::back_inserter(names), &Rung::name);
    TradeoffCheck check{.rung = table.choice("of", names), .error = table.choice("error", error_keys())};
    check.at_most = table.number("at_most", kNotNegative);
    table.finish();
    return check;
}

TradeoffScene read_scene(TomlTable& table, findings::ExperimentFile& file) {
    TradeoffScene scene{.name = findings::read_name(table)};
    scene.title = table.text_or("title", scene.name);
    file.add_subject(table, "name", scene.name);
    scene.file = referred_file(table.file(), table.text("scene"));
    const TomlTable world = TomlTable::read(scene.file);
    scene.setup = render::read_scene_setup(world);
    scene.stated = world.stated();
    scene.rungs = rungs_named(findings::names_of(table, "rungs", rung_names()));
    TradeoffSettings& settings = scene.settings;
    settings.pixels = table.integer_or("pixels", settings.pixels, 64, 100'000'000);
    settings.samples = table.integer_or("samples_per_pixel", settings.samples, 1, 1 << 20);
    settings.seeds = table.integer_or("seeds", settings.seeds, 2, 1000);
    settings.noise = table.number_or("noise", settings.noise, kPositive);
    for (TomlTable& check : table.tables("checks")) {
        scene.checks.push_back(read_check(check, scene));
    }
    table.finish();
    return scene;
}

std::vector<std::filesystem::path> files_of(const TradeoffScene& scene) {
    std::vector<std::filesystem::path> files = {scene.file};
    if (!scene.setup.chart) {
        std::ranges::move(scene::named_files(scene.setup.scene), std::back_inserter(files));
    }
    if (!scene.setup.camera.lens.empty()) {
        std::ranges::move(formats::files_of_lens(scene.setup.camera.lens), std::back_inserter(files));
    }
    return files;
}

Json field_json(const FieldError& at) {
    Json json{{"image_height", at.image_height}};
    const auto put = [&](const char* key, const Measured& measured) {
        json[key] = measured.value;
        json[std::string(key) + "_standard_error"] = measured.standard_error;
    };
    put("position_rms_um", at.position_um);
    put("image_rms_px", at.image_px);
    put("blur_px", at.blur_px);
    put("exposure_ev", at.exposure_ev);
    return json;
}

Json rung_json(const MeasuredRung& rung) {
    Json json{{"model", rung.name}};
    if (!rung.not_applicable.empty()) {
        json["not_applicable"] = rung.not_applicable;
        return json;
    }
    for (const RungError& error : rung_errors()) {
        const Measured measured = error.of(rung);
        json["error"][error.key] = measured.value;
        json["error"][std::string(error.key) + "_standard_error"] = measured.standard_error;
    }
    json["error"]["ciede2000_noise"] = rung.picture.ciede2000.noise;
    json["error"]["flip_noise"] = rung.picture.flip.noise;
    json["error"]["ciede2000_mean_at_equal_time"] = rung.ciede2000_at_equal_time;
    json["error"]["picture_exposure_ev"] = rung.picture.exposure_ev.value;
    json["error"]["picture_exposure_ev_standard_error"] = rung.picture.exposure_ev.standard_error;
    json["error"]["light_lost_percent"] = 100.0 * rung.field.lost;
    json["cost"] = {{"ns_per_path", rung.cost.ns_per_path},
                    {"ns_per_sample", rung.cost.ns_per_sample},
                    {"samples_per_pixel", rung.cost.samples},
                    {"seconds", rung.cost.seconds},
                    {"memory_mib", rung.cost.memory_mib}};
    json["pareto"] = rung.is_pareto;
    json["fields"] = Json::list();
    for (const FieldError& at : rung.field.at) {
        json["fields"].push_back(field_json(at));
    }
    return json;
}

std::vector<MeasuredRung> applicable(std::vector<MeasuredRung> rungs) {
    std::erase_if(rungs, [](const MeasuredRung& rung) { return !rung.not_applicable.empty(); });
    return rungs;
}

/// What of an error a logarithmic axis can show: no less than what is known of it.
double shown(const Measured& measured) {
    constexpr double kLeast = 1e-4;
    return std::max({measured.value, measured.standard_error, kLeast});
}

draw::PlotChart pareto_chart(const RungError& error, const std::vector<MeasuredRung>& rungs, double noise) {
    draw::PlotChart chart{.title = error.title,
                          .x = {.label = fmt::format("Time to {:g} % noise, one core", 100.0 * noise),
                                .unit = "s",
                                .scale = draw::AxisScale::logarithmic},
                          .y = {.label = "Error", .unit = error.unit, .scale = draw::AxisScale::logarithmic}};
    draw::ChartCurve front{.label = "front: nothing cheaper errs less",
                           .points = {},
                           .colour = draw::kQuiet,
                           .line = draw::CurveLine::dashed};
    for (std::size_t i = 0; i < rungs.size(); ++i) {
        front.points.push_back({rungs[i].cost.seconds, shown(error.of(rungs[i]))});
        chart.curves.push_back({.label = rungs[i].name,
                                .points = {front.points.back()},
                                .colour = draw::series_colour(i),
                                .line = draw::CurveLine::none,
                                .marker = static_cast<draw::CurveMarker>(1 + i % 7),
                                .marker_size = 9.0});
    }
    std::ranges::sort(front.points, {}, &Vec2d::x);
    double least = std::numeric_limits<double>::infinity();
    std::erase_if(front.points, [&](const Vec2d& at) {
        const bool is_beaten = at.y >= least;
        least = std::min(least, at.y);
        return is_beaten;
    });
    chart.curves.insert(chart.curves.begin(), std::move(front));
    return chart;
}

/// The mean over rings of the frame, of what a point of it has.
calibration::Curve ring_curve(const FieldErrors& errors, Measured FieldError::*what) {
    calibration::Curve curve;
    for (std::size_t ring = 0; ring < kRings; ++ring) {
        double height = 0.0;
        double value = 0.0;
        double variance = 0.0;
        double count = 0.0;
        for (const FieldError& at : errors.at) {
            if (std::min(kRings - 1, static_cast<std::size_t>(at.image_height * kRings)) == ring) {
                height += at.image_height;
                value += (at.*what).value;
                variance += std::pow((at.*what).standard_error, 2);
                count += 1.0;
            }
        }
        if (count > 0.0) {
            const double half = calibration::k95 * std::sqrt(variance) / count;
            calibration::append(
                curve, height / count,
                {.value = value / count, .lower_95 = value / count - half, .upper_95 = value / count + half});
        }
    }
    curve.covered_image_height = curve.image_height.empty() ? 0.0 : curve.image_height.back();
    return curve;
}

std::string subject_id(const TradeoffScene& scene, const MeasuredRung& rung) {
    return fmt::format("{}-{}", scene.name, rung.name);
}

std::vector<findings::Plot> field_plots(const TradeoffScene& scene, const std::vector<MeasuredRung>& rungs) {
    struct Kind {
        const char* key;
        const char* title;
        const char* unit;
        Measured FieldError::*what;
    };
    constexpr std::array kKinds = {
        Kind{"position", "Where a model puts the lens's rays", "µm", &FieldError::position_um},
        Kind{"image", "Where the image of a point is", "px", &FieldError::image_px},
        Kind{"blur", "How much wider the image of a point is", "px", &FieldError::blur_px},
        Kind{"exposure", "How bright an even world is", "EV", &FieldError::exposure_ev}};
    std::vector<findings::Plot> plots;
    for (const Kind& kind : kKinds) {
        findings::Plot plot{.id = fmt::format("{}-{}", scene.name, kind.key),
                            .title = kind.title,
                            .subtitle = fmt::format("{}, against the lens itself, over the frame", scene.title),
                            .y_label = "model against lens",
                            .y_unit = kind.unit};
        for (const MeasuredRung& rung : rungs) {
            plot.series.push_back({.label = rung.name,
                                   .subject = subject_id(scene, rung),
                                   .style = "difference",
                                   .curve = ring_curve(rung.field, kind.what)});
        }
        plots.push_back(std::move(plot));
    }
    return plots;
}

std::string with_error(const Measured& measured, const char* unit) {
    return fmt::format("{:.3g} ± {:.1g}{}{}", measured.value, measured.standard_error, *unit != '\0' ? " " : "", unit);
}

findings::Subject subject_of(const TradeoffScene& scene, const MeasuredRung& rung) {
    findings::Subject subject{.id = subject_id(scene, rung), .kind = "model", .label = rung.name};
    if (!rung.not_applicable.empty()) {
        subject.facts.push_back({"not for this lens", rung.not_applicable});
        return subject;
    }
    for (const RungError& error : rung_errors()) {
        subject.facts.push_back({error.title, with_error(error.of(rung), error.unit)});
    }
    subject.facts.push_back(
        {"noise of these pictures, CIEDE2000", fmt::format("{:.3g}", rung.picture.ciede2000.noise)});
    subject.facts.push_back(
        {"at the reference's time, CIEDE2000", fmt::format("{:.3g}", rung.ciede2000_at_equal_time)});
    subject.facts.push_back({"a path out of the camera", fmt::format("{:.0f} ns", rung.cost.ns_per_path)});
    subject.facts.push_back({fmt::format("to {:g} % noise", 100.0 * scene.settings.noise),
                             fmt::format("{:.3g} s of one core", rung.cost.seconds)});
    subject.facts.push_back({"memory", fmt::format("{:.3g} MiB", rung.cost.memory_mib)});
    subject.pictures.push_back(findings::shown_picture(subject.id + "/picture.png", rung.name, rung.picture_rgb));
    return subject;
}

}  // namespace

const std::vector<RungError>& rung_errors() {
    static const std::vector<RungError> errors = {
        {"position_rms_um", "rays on the film, rms", "µm",
         [](const MeasuredRung& r) { return r.field.frame.position_um; }},
        {"image_rms_px", "image of a point, rms", "px", [](const MeasuredRung& r) { return r.field.frame.image_px; }},
        {"blur_rms_px", "its width, rms", "px", [](const MeasuredRung& r) { return r.field.frame.blur_px; }},
        {"exposure_ev", "exposure over the frame, rms", "EV",
         [](const MeasuredRung& r) { return r.field.frame.exposure_ev; }},
        {"ciede2000_mean", "colour of the picture, CIEDE2000", "",
         [](const MeasuredRung& r) { return r.picture.ciede2000.bias; }},
        {"flip", "FLIP", "", [](const MeasuredRung& r) { return r.picture.flip.bias; }}};
    return errors;
}

std::vector<std::string> rung_names() {
    std::vector<std::string> names;
    std::ranges::transform(ladder(), std::back_inserter(names), &Rung::name);
    return names;
}

std::vector<Rung> rungs_named(const std::vector<std::string>& names) {
    std::vector<Rung> rungs;
    std::ranges::copy_if(ladder(), std::back_inserter(rungs), [&](const Rung& rung) {
        return rung.name == kReferenceRung || findings::is_wanted(names, rung.name);
    });
    return rungs;
}

Json tradeoff_json(const std::vector<MeasuredRung>& rungs) {
    Json json{{"reference", kReferenceRung}, {"rungs", Json::list()}};
    for (const MeasuredRung& rung : rungs) {
        json["rungs"].push_back(rung_json(rung));
    }
    return json;
}

std::string pareto_svg(const std::string& title, const std::vector<MeasuredRung>& rungs, double noise) {
    draw::ChartGrid grid{.title = title,
                         .caption =
                             "Against the lens itself, traced in double; errors that are not known better are "
                             "drawn at what is known of them",
                         .panels = {},
                         .columns = 3,
                         .shares_y = false,
                         .frame = {260.0, 240.0}};
    const std::vector<MeasuredRung> all = applicable(rungs);
    for (const char* key : {"image_rms_px", "exposure_ev", "ciede2000_mean"}) {
        grid.panels.push_back(pareto_chart(error_named(key), all, noise));
    }
    return draw::chart_grid_svg(grid);
}

findings::Findings tradeoff_findings(const TradeoffScene& scene, const std::vector<MeasuredRung>& rungs) {
    findings::Findings found{.subjects_title = "Models"};
    for (const TradeoffCheck& check : scene.checks) {
        const RungError& error = error_named(check.error);
        const Measured measured = error.of(*std::ranges::find(rungs, check.rung, &MeasuredRung::name));
        found.checks.push_back({.id = fmt::format("{}-{}-{}", scene.name, check.rung, check.error),
                                .group = scene.title,
                                .subject = fmt::format("{}-{}", scene.name, check.rung),
                                .label = fmt::format("{}: {}", check.rung, error.title),
                                .value = measured.value,
                                .sigma = measured.standard_error,
                                .unit = error.unit,
                                .limit = check.at_most,
                                .explanation = "Against the lens itself, traced in double."});
    }
    findings::Subject front{.id = scene.name, .kind = "scene", .label = scene.title};
    constexpr double kWidth = 1080.0;
    constexpr double kHeight = 420.0;
    front.pictures.push_back({.name = scene.name + "/front.svg",
                              .caption = "Error against cost",
                              .width = kWidth,
                              .height = kHeight,
                              .bytes = pareto_svg(scene.title, rungs, scene.settings.noise)});
    found.subjects.push_back(std::move(front));
    std::ranges::transform(rungs, std::back_inserter(found.subjects),
                           [&](const MeasuredRung& rung) { return subject_of(scene, rung); });
    found.plots = field_plots(scene, applicable(rungs));
    found.inputs = files_of(scene);
    Json table = tradeoff_json(rungs);
    table["name"] = scene.name;
    found.tables = {{"tradeoff", std::move(table)}};
    return found;
}

findings::Study read_tradeoff(findings::ExperimentFile& file) {
    std::vector<TradeoffScene> scenes;
    for (TomlTable& table : file.top.tables("tradeoff")) {
        scenes.push_back(read_scene(table, file));
    }
    if (scenes.empty()) {
        return {};
    }
    return [scenes = std::move(scenes)](const findings::RunSettings& settings, const findings::RunProgress& progress,
                                        const findings::Findings&) {
        findings::Findings found{.subjects_title = "Models"};
        Json table = Json::list();
        for (const TradeoffScene& scene : scenes) {
            TradeoffSettings own = scene.settings;
            own.probe.seed = settings.seed;
            own.probe.threads = settings.threads;
            own.cache = settings.cache;
            std::vector<std::string> names;
            std::ranges::transform(scene.rungs, std::back_inserter(names), &Rung::name);
            std::vector<MeasuredRung> rungs = settings.steps.step(
                "tradeoff",
                {.settings = {{"scene", scene.stated},
                              {"rungs", names},
                              {"pixels", own.pixels},
                              {"samples_per_pixel", own.samples},
                              {"seeds", own.seeds},
                              {"noise", own.noise},
                              {"seed", settings.seed}},
                 .files = files_of(scene)},
                [&] {
                    return measure_tradeoff(scene.setup, scene.rungs, own, [&](const std::string& rung, double done) {
                        progress(fmt::format("{}: {}", scene.name, rung), done);
                    });
                });
            compare_rungs(rungs);
            findings::Findings more = tradeoff_findings(scene, rungs);
            table.push_back(std::move(more.tables.front().second));
            more.tables.clear();
            findings::append(found, std::move(more));
        }
        found.tables.emplace_back("tradeoff", std::move(table));
        return found;
    };
}

}  // namespace lensproof::studies
