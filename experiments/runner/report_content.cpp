#include "experiments/runner/report_content.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "engine/base/json.h"
#include "experiments/runner/provenance.h"
#include "experiments/studies/certainty_map.h"

namespace lensproof::runner {

namespace {
/// .s0 … .s6 of the report's page, on white.
constexpr std::array kSubjectColours = {"#0072b2", "#c77b00", "#b5548a", "#3d9fd8", "#8a8200", "#009e73", "#d55e00"};

Json points_json(const calibration::ProfileView& view) {
    Json points = Json::list();
    for (const calibration::ProfilePoint& point : view.points) {
        points.push_back({point.image_px.x, point.image_px.y, point.residual_px.x, point.residual_px.y});
    }
    return points;
}

Json subject_json(const Subject& subject) {
    Json json{{"id", subject.name}, {"kind", subject.simulated ? "simulation" : "photos"}, {"label", subject.label}};
    for (const Fact& fact : subject.facts) {
        json["facts"].push_back({{"label", fact.label}, {"value", fact.value}});
    }
    if (subject.profile.geometry) {
        json["focal_length_px"] = {{"value", calibration::focal_length_px(subject.profile.geometry->model)},
                                   {"sigma", subject.profile.geometry->standard_error(0)}};
    }
    for (const ShownPicture& picture : subject.pictures) {
        Json entry{
            {"name", picture.name}, {"caption", picture.caption}, {"width", picture.width}, {"height", picture.height}};
        if (picture.view >= 0) {
            const calibration::ProfileView& view = subject.profile.views.at(picture.view);
            entry["points"] = points_json(view);
            if (!view.found) {
                entry["caption"] = fmt::format("{} (left out: {})", picture.caption, view.reason);
            }
        }
        json["pictures"].push_back(std::move(entry));
    }
    return json;
}

/// `floor`: the method's own error in it.
Json series_json(const std::string& label, const std::string& subject, const char* style,
                 const calibration::Curve& curve, std::optional<double> floor = std::nullopt) {
    Json json{{"label", label},          {"subject", subject},
              {"style", style},          {"x", curve.image_height},
              {"y", curve.value},        {"lower", curve.lower_95},
              {"upper", curve.upper_95}, {"covered_to", curve.covered_image_height}};
    if (floor) {
        json["floor"] = *floor;
    }
    return json;
}

std::optional<double> rms_floor(const Subject& subject, const std::string& curve) {
    const calibration::CurveFloor* floor = calibration::floor_of(subject.profile.self_test, curve);
    return floor != nullptr ? std::optional(floor->rms) : std::nullopt;
}

struct Plot {
    std::string id;
    std::string title;
    std::string subtitle;
    std::string y_label;
    std::string y_unit;
    Json series = Json::list();
    std::optional<double> limit;
};

void append_plot(Json& plots, const Plot& plot) {
    if (plot.series.empty()) {
        return;
    }
    Json json{{"id", plot.id},
              {"title", plot.title},
              {"subtitle", plot.subtitle},
              {"x_label", "image height (of the half-diagonal)"},
              {"y_label", plot.y_label},
              {"x_unit", ""},
              {"y_unit", plot.y_unit},
              {"series", plot.series}};
    if (plot.limit) {
        json["limit"] = *plot.limit;
    }
    plots.push_back(std::move(json));
}

void add_measured(Plot& plot, const Subject& subject, const std::string& curve, const std::string& suffix = "") {
    const auto found = subject.profile.curves.find(curve);
    if (found != subject.profile.curves.end()) {
        plot.series.push_back(
            series_json(subject.name + suffix, subject.name, "measured", found->second, rms_floor(subject, curve)));
    }
    if (subject.traced && subject.traced->curves.contains(curve)) {
        plot.series.push_back(series_json(subject.name + suffix + ", traced", subject.name, "reference",
                                          subject.traced->curves.at(curve)));
    }
}

/// Photos of one channel have their vignetting under that channel's name.
std::string luminance_curve(const Subject& subject) {
    for (const char* name : {"vignetting_G_ev", "vignetting_Y_ev"}) {
        if (subject.profile.curves.contains(name)) {
            return name;
        }
    }
    return "vignetting_G_ev";
}

/// Tangential and sagittal curves of every subject that has them, in green (grey photos: their one channel); a curve
/// is named `prefix`, direction, channel, `suffix`.
Plot both_ways(const ExperimentResult& result, const std::string& prefix, const std::string& suffix, Plot plot) {
    for (const Subject& subject : result.subjects) {
        for (const char* direction : {"tangential", "sagittal"}) {
            for (const char* channel : {"G", "Y"}) {
                add_measured(plot, subject, fmt::format("{}_{}_{}{}", prefix, direction, channel, suffix),
                             fmt::format(", {}", direction));
            }
        }
    }
    return plot;
}

Plot measured_plot(const ExperimentResult& result, Plot plot, const std::function<bool(const Subject&)>& belongs,
                   const std::string& curve) {
    for (const Subject& subject : result.subjects) {
        if (belongs(subject)) {
            add_measured(plot, subject, curve);
        }
    }
    return plot;
}

/// Measured minus traced, for every simulation, with the tightest limit of its check.
Plot closed_loop_plot(const ExperimentResult& result, const std::vector<Simulation>& simulations, Plot plot,
                      const std::function<std::optional<calibration::CurveDifference>(const Subject&)>& compare,
                      const std::function<std::optional<double>(const ClosedLoopLimits&)>& limit,
                      const std::function<std::optional<double>(const Subject&)>& floor) {
    for (const Subject& subject : result.subjects) {
        if (!subject.traced) {
            continue;
        }
        if (const std::optional<calibration::CurveDifference> difference = compare(subject)) {
            plot.series.push_back(
                series_json(subject.name, subject.name, "difference", difference->curve, floor(subject)));
        }
        const std::optional<double> own =
            limit(std::ranges::find(simulations, subject.name, &Simulation::name)->limits);
        if (own) {
            plot.limit = plot.limit ? std::min(*plot.limit, *own) : *own;
        }
    }
    return plot;
}

bool is_fisheye(const Subject& subject) {
    return subject.profile.geometry && !calibration::is_perspective(subject.profile.geometry->model);
}

Json plots_json(const Experiment& experiment, const ExperimentResult& result) {
    Json plots = Json::list();
    const auto& simulations = experiment.simulations;
    append_plot(plots, measured_plot(
                           result,
                           {.id = "distortion",
                            .title = "Distortion",
                            .subtitle = "against f·tan θ, f being the slope on the axis",
                            .y_label = "distortion",
                            .y_unit = "%"},
                           [](const Subject& s) { return !is_fisheye(s); }, "distortion_percent"));
    append_plot(plots, measured_plot(result,
                                     {.id = "distortion-fisheye",
                                      .title = "Distortion of fisheyes",
                                      .subtitle = "against f·θ, f being the slope on the axis",
                                      .y_label = "distortion",
                                      .y_unit = "%"},
                                     is_fisheye, "distortion_equidistant_percent"));
    append_plot(plots, closed_loop_plot(
                           result, simulations,
                           {.id = "distortion-difference",
                            .title = "Image position: measured minus traced",
                            .subtitle = "radial distance of the image of one direction",
                            .y_label = "difference",
                            .y_unit = "px"},
                           [](const Subject& s) { return calibration::radial_difference_px(s.profile, *s.traced); },
                           [](const ClosedLoopLimits& l) { return l.distortion_largest_px; },
                           [](const Subject& s) { return rms_floor(s, "radial_px"); }));

    Plot vignetting{.id = "vignetting",
                    .title = "Vignetting",
                    .subtitle = "light relative to the axis, green (grey photos: their one channel)",
                    .y_label = "relative illumination",
                    .y_unit = "EV"};
    for (const Subject& subject : result.subjects) {
        add_measured(vignetting, subject, luminance_curve(subject));
    }
    append_plot(plots, vignetting);
    append_plot(plots,
                closed_loop_plot(
                    result, simulations,
                    {.id = "vignetting-difference",
                     .title = "Vignetting: measured minus traced",
                     .subtitle = "relative illumination, as a share of the axis",
                     .y_label = "difference",
                     .y_unit = "%"},
                    [](const Subject& s) -> std::optional<calibration::CurveDifference> {
                        auto d = calibration::difference(s.profile, *s.traced, "vignetting_G");
                        for (auto* values : d ? std::vector{&d->curve.value, &d->curve.lower_95, &d->curve.upper_95}
                                              : std::vector<std::vector<double>*>{}) {
                            std::ranges::transform(*values, values->begin(), [](double v) { return 100.0 * v; });
                        }
                        return d;
                    },
                    [](const ClosedLoopLimits& l) { return l.vignetting_percent; },
                    [](const Subject& s) {
                        const auto floor = rms_floor(s, "vignetting_G");
                        return floor ? std::optional(100.0 * *floor) : std::nullopt;
                    }));

    for (const auto& [channel, colour] : {std::pair{"R", "red"}, std::pair{"B", "blue"}}) {
        const std::string curve = fmt::format("chromatic_shift_{}_px", channel);
        append_plot(plots, measured_plot(
                               result,
                               {.id = fmt::format("chromatic-{}", colour),
                                .title = fmt::format("Chromatic shift of {}", colour),
                                .subtitle = fmt::format("radial position of {} minus green", colour),
                                .y_label = "shift",
                                .y_unit = "px"},
                               [](const Subject&) { return true; }, curve));
        append_plot(plots, closed_loop_plot(
                               result, simulations,
                               {.id = fmt::format("chromatic-{}-difference", colour),
                                .title = fmt::format("Chromatic shift of {}: measured minus traced", colour),
                                .subtitle = "",
                                .y_label = "difference",
                                .y_unit = "px"},
                               [&](const Subject& s) { return calibration::difference(s.profile, *s.traced, curve); },
                               [](const ClosedLoopLimits& l) { return l.chromatic_shift_px; },
                               [&](const Subject& s) { return rms_floor(s, curve); }));
    }

    append_plot(plots, both_ways(result, "mtf50", "",
                                 {.id = "sharpness",
                                  .title = "Sharpness",
                                  .subtitle = "MTF50 along the radius (tangential) and across (sagittal), green",
                                  .y_label = "MTF50",
                                  .y_unit = "cycles/px"}));
    append_plot(plots, both_ways(result, "best_focus", "_mm",
                                 {.id = "field-curvature",
                                  .title = "Field curvature",
                                  .subtitle = "where the focus has to stand for the sharpest picture, green",
                                  .y_label = "focus",
                                  .y_unit = "mm"}));

    Plot against{.id = "comparisons",
                 .title = "Lenses against each other",
                 .subtitle = "distortion, difference of the measured curves",
                 .y_label = "difference",
                 .y_unit = "%"};
    for (const ComparisonResult& compared : result.comparisons) {
        if (compared.difference && compared.comparison.curve.ends_with("_percent")) {
            against.series.push_back(series_json(compared.comparison.of + " − " + compared.comparison.with,
                                                 compared.comparison.of, "difference", compared.difference->curve,
                                                 compared.floor));
            against.limit = compared.comparison.limit;
        }
    }
    append_plot(plots, against);
    return plots;
}

bool has_certainty(const Subject& subject) {
    return subject.profile.geometry && subject.profile.geometry->uncertainty;
}

std::string certainty_name(const Subject& subject) {
    return subject.name + "/certainty.svg";
}

/// The subjects' certainty over their frames, in one range of colours; with the subject's place in the report.
std::map<std::string, studies::CertaintyMap> certainty_maps(const ExperimentResult& result) {
    std::vector<const calibration::Profile*> profiles;
    profiles.reserve(result.subjects.size());
    for (const Subject& subject : result.subjects) {
        profiles.push_back(&subject.profile);
    }
    const draw::AxisRange range = studies::certainty_range(profiles);
    std::map<std::string, studies::CertaintyMap> maps;
    for (std::size_t i = 0; i < result.subjects.size(); ++i) {
        const Subject& subject = result.subjects[i];
        if (has_certainty(subject)) {
            maps[certainty_name(subject)] =
                studies::certainty_map(subject.profile, fmt::format("{}, {}", subject.name, subject.label),
                                       kSubjectColours.at(i % kSubjectColours.size()), range);
        }
    }
    return maps;
}

Json maps_json(const ExperimentResult& result) {
    const std::map<std::string, studies::CertaintyMap> maps = certainty_maps(result);
    Json json = Json::list();
    for (const Subject& subject : result.subjects) {
        if (has_certainty(subject)) {
            const std::string name = certainty_name(subject);
            json.push_back({{"name", name}, {"subject", subject.name}, {"caption", maps.at(name).caption}});
        }
    }
    return json;
}

std::string summary_of(const Experiment& experiment, const ExperimentResult& result) {
    int passed = 0;
    for (const Check& check : result.checks) {
        passed += check.verdict() == Verdict::pass ? 1 : 0;
    }
    return fmt::format("{} {} of {} checks hold.", experiment.summary, passed, result.checks.size());
}

}  // namespace

Json check_json(const Check& check) {
    std::string explanation = check.explanation;
    if (check.is_below_floor()) {
        explanation += fmt::format(
            "{}The difference is not larger than the method's own error, {:.2g}{}{}: it may be "
            "the method's alone.",
            explanation.empty() ? "" : " ", *check.floor, check.unit.empty() ? "" : " ", check.unit);
    }
    return {{"id", check.id},
            {"group", check.group},
            {"subject", check.subject},
            {"label", check.label},
            {"value", check.value},
            {"sigma", check.sigma},
            {"unit", check.unit},
            {"limit", check.limit},
            {"expect", expectation_name(check.expectation)},
            {"target", check.expectation == Expectation::within ? Json(check.target) : Json(nullptr)},
            {"verdict", verdict_name(check.verdict())},
            {"floor", check.floor ? *check.floor : Json(nullptr)},
            {"explanation", explanation}};
}

Json provenance_json(std::vector<std::filesystem::path> inputs, const RunSettings& settings) {
    Json provenance{{"program", "lensproof"}, {"version", LENSPROOF_VERSION}, {"commit", source_commit()}};
    provenance["settings"] = {{"seed", settings.seed}};
    std::ranges::sort(inputs);
    inputs.erase(std::unique(inputs.begin(), inputs.end()), inputs.end());
    for (const std::filesystem::path& input : inputs) {
        provenance["inputs"].push_back({{"file", portable_path(input)}, {"sha256", sha256(input)}});
    }
    return provenance;
}

Json report_json(const Experiment& experiment, const ExperimentResult& result, const RunSettings& settings) {
    Json report{{"schema", "lensproof-report/1"},
                {"title", experiment.title},
                {"summary", summary_of(experiment, result)},
                {"verdict", verdict_name(overall(result.checks))},
                {"checks", Json::list()},
                {"subjects", Json::list()}};
    for (const Check& check : result.checks) {
        report["checks"].push_back(check_json(check));
    }
    for (const Subject& subject : result.subjects) {
        report["subjects"].push_back(subject_json(subject));
    }
    report["plots"] = plots_json(experiment, result);
    report["maps"] = maps_json(result);
    report["provenance"] = provenance_json(result.inputs, settings);
    report["reproduce"] = fmt::format("./lensproof run {} --seed {}", portable_path(experiment.file), settings.seed);
    return report;
}

std::map<std::string, std::string> report_pictures(const ExperimentResult& result) {
    std::map<std::string, std::string> pictures;
    for (const Subject& subject : result.subjects) {
        for (const ShownPicture& picture : subject.pictures) {
            if (!picture.png.empty()) {
                pictures[picture.name] = picture.png;
            }
        }
    }
    for (auto& [name, map] : certainty_maps(result)) {
        pictures[name] = std::move(map.svg);
    }
    return pictures;
}

}  // namespace lensproof::runner
