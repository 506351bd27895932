#include "experiments/studies/tradeoff/tradeoff_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"
#include "experiments/findings/shown_picture.h"

namespace lensproof::studies {

namespace {

constexpr std::size_t kHeightRings = 8;  // of image heights, that curves have a sample each of

const RungError& error_named(const std::string& key) {
    return *std::ranges::find(rung_errors(), key, &RungError::key);
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
    put("mtf_difference_tangential", at.mtf_tangential);
    put("mtf_difference_sagittal", at.mtf_sagittal);
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
    json["error"]["flip_at_equal_time"] = rung.flip_at_equal_time;
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
                          .x = {.label = fmt::format("Time to {:g} % noise", 100.0 * noise),
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
    for (std::size_t ring = 0; ring < kHeightRings; ++ring) {
        double height = 0.0;
        double value = 0.0;
        double variance = 0.0;
        double count = 0.0;
        for (const FieldError& at : errors.at) {
            if (std::min(kHeightRings - 1, static_cast<std::size_t>(at.image_height * kHeightRings)) == ring) {
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
        Kind{"exposure", "How bright an even world is", "EV", &FieldError::exposure_ev},
        Kind{"mtf-tangential", "MTF at the pixels' Nyquist frequency, tangential", "", &FieldError::mtf_tangential},
        Kind{"mtf-sagittal", "MTF at the pixels' Nyquist frequency, sagittal", "", &FieldError::mtf_sagittal}};
    std::vector<findings::Plot> plots;
    for (const Kind& kind : kKinds) {
        findings::Plot plot{.id = fmt::format("{}-{}", scene.name, kind.key),
                            .title = kind.title,
                            .subtitle = fmt::format("{}, against the lens itself, over the frame", scene.title),
                            .y_label = "model against lens",
                            .y_unit = kind.unit};
        for (const MeasuredRung& rung : rungs) {
            plot.series.push_back({.label = rung.name,
                                   .subject = rung.name,
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

/// All that is known of a model in one scene.
std::vector<findings::Fact> facts_of(const MeasuredRung& rung, double noise) {
    std::vector<findings::Fact> facts;
    for (const RungError& error : rung_errors()) {
        facts.push_back({error.title, with_error(error.of(rung), error.unit)});
    }
    facts.push_back({"noise of these pictures", fmt::format("CIEDE2000 {:.3g}, FLIP {:.3g}",
                                                            rung.picture.ciede2000.noise, rung.picture.flip.noise)});
    facts.push_back({"at the reference's time", fmt::format("CIEDE2000 {:.3g}, FLIP {:.3g}",
                                                            rung.ciede2000_at_equal_time, rung.flip_at_equal_time)});
    facts.push_back({"a path out of the camera", fmt::format("{:.0f} ns", rung.cost.ns_per_path)});
    facts.push_back(
        {fmt::format("to {:g} % noise", 100.0 * noise), fmt::format("{:.3g} s of one core", rung.cost.seconds)});
    facts.push_back({"memory", fmt::format("{:.3g} MiB", rung.cost.memory_mib)});
    return facts;
}

std::string in_short(const MeasuredRung& rung) {
    const FieldError& frame = rung.field.frame;
    return fmt::format("{:.2g} px off, {:.2g} of width, MTF {:.2g}, {:.2g} EV, CIEDE2000 {:.2g}, FLIP {:.2g}, {:.2g} s",
                       frame.image_px.value, frame.blur_px.value, frame.mtf.value, frame.exposure_ev.value,
                       rung.picture.ciede2000.bias.value, rung.picture.flip.bias.value, rung.cost.seconds);
}

std::vector<findings::Subject> model_subjects(const std::vector<MeasuredScene>& scenes) {
    std::vector<findings::Subject> models;
    for (const MeasuredScene& measured : scenes) {
        for (const MeasuredRung& rung : measured.rungs) {
            auto model = std::ranges::find(models, rung.name, &findings::Subject::id);
            if (model == models.end()) {
                models.push_back({.id = rung.name, .kind = "model", .label = rung.name});
                model = models.end() - 1;
            }
            if (!rung.not_applicable.empty()) {
                model->facts.push_back({measured.scene.title, "not here: " + rung.not_applicable});
            } else if (scenes.size() == 1) {
                model->facts = facts_of(rung, measured.scene.settings.noise);
            } else {
                model->facts.push_back({measured.scene.title, in_short(rung)});
            }
        }
    }
    return models;
}

/// With the front, and each model's picture over the reference's.
findings::Subject scene_subject(const MeasuredScene& measured) {
    const TradeoffScene& scene = measured.scene;
    findings::Subject subject{.id = scene.name, .kind = "scene", .label = scene.title};
    constexpr double kWidth = 800.0;
    constexpr double kHeight = 420.0;
    subject.pictures.push_back({.name = scene.name + "/front.svg",
                                .caption = "Error against cost",
                                .width = kWidth,
                                .height = kHeight,
                                .bytes = pareto_svg(scene.title, measured.rungs, scene.settings.noise)});
    const auto picture_of = [&](const MeasuredRung& rung) {
        return findings::shown_picture(fmt::format("{}/{}.png", scene.name, rung.name), "Each model's picture",
                                       rung.picture_rgb);
    };
    const auto reference = std::ranges::find(measured.rungs, kReferenceRung, &MeasuredRung::name);
    findings::Picture pictures = picture_of(*reference);
    pictures.label = reference->name;
    for (const MeasuredRung& rung : applicable(measured.rungs)) {
        if (rung.name != kReferenceRung) {
            findings::Picture layer = picture_of(rung);
            pictures.layers.push_back({.name = layer.name, .label = rung.name, .bytes = std::move(layer.bytes)});
        }
    }
    subject.pictures.push_back(std::move(pictures));
    return subject;
}

Json suffices_json(const TradeoffScene& scene, const SufficientRung& found, const Tolerance& tolerance) {
    Json json{{"picture", scene.picture},
              {"lens", scene.lens},
              {"tolerance", scene.stated_tolerance},
              {"model", found.rung.name},
              {"sure", found.is_sure},
              {"times_as_fast", found.speed_up},
              {"largest_error", largest_error(found.rung, tolerance)}};
    const Contribution error = asked_of(found.rung);
    const auto put = [&](const char* key, const Measured& measured) {
        json["error"][key] = measured.value;
        json["error"][std::string(key) + "_standard_error"] = measured.standard_error;
    };
    put("px", error.px);
    put("ev", error.ev);
    put("ciede2000", error.ciede2000);
    if (found.cheaper) {
        json["cheaper"] = found.cheaper->name;
        json["largest_error_of_cheaper"] = largest_error(*found.cheaper, tolerance);
    }
    return json;
}

/// A subject of each picture, and a row of each scene.
struct Sufficient {
    std::vector<findings::Subject> subjects;
    Json rows = Json::list();
};

Sufficient what_suffices(const std::vector<MeasuredScene>& scenes) {
    Sufficient all;
    for (const MeasuredScene& measured : scenes) {
        const TradeoffScene& scene = measured.scene;
        const Tolerance tolerance = parse_tolerance(scene.stated_tolerance);
        const SufficientRung found = sufficient_rung(measured.rungs, tolerance);
        all.rows.push_back(suffices_json(scene, found, tolerance));
        auto subject = std::ranges::find(all.subjects, scene.picture, &findings::Subject::label);
        if (subject == all.subjects.end()) {
            all.subjects.push_back({.id = scene.name + "-suffices",
                                    .kind = "what suffices at " + scene.stated_tolerance,
                                    .label = scene.picture});
            subject = all.subjects.end() - 1;
        }
        std::string text =
            found.rung.name == kReferenceRung
                ? fmt::format("none but {}", kReferenceRung)
                : fmt::format("{}, {:.1f} times as fast: {} wrong{}", found.rung.name, found.speed_up,
                              largest_error(found.rung, tolerance), found.is_sure ? "" : ", as far as noise tells");
        if (found.cheaper) {
            text += fmt::format("; {}: {}", found.cheaper->name, largest_error(*found.cheaper, tolerance));
        }
        subject->facts.push_back({scene.lens, text});
    }
    return all;
}

void add_checks(const MeasuredScene& measured, std::vector<findings::Check>& checks) {
    for (const TradeoffCheck& check : measured.scene.checks) {
        const RungError& error = error_named(check.error);
        const Measured found = error.of(*std::ranges::find(measured.rungs, check.rung, &MeasuredRung::name));
        checks.push_back({.id = fmt::format("{}-{}-{}", measured.scene.name, check.rung, check.error),
                          .group = measured.scene.title,
                          .subject = measured.scene.name,
                          .label = fmt::format("{}: {}", check.rung, error.title),
                          .value = found.value,
                          .sigma = found.standard_error,
                          .unit = error.unit,
                          .limit = check.at_most,
                          .explanation = "Against the lens itself, traced in double."});
    }
}

}  // namespace

const std::vector<RungError>& rung_errors() {
    static const std::vector<RungError> errors = {
        {"position_rms_um", "rays on the film, rms", "µm",
         [](const MeasuredRung& r) { return r.field.frame.position_um; }},
        {"image_rms_px", "image of a point, rms", "px", [](const MeasuredRung& r) { return r.field.frame.image_px; }},
        {"blur_rms_px", "its width, rms", "px", [](const MeasuredRung& r) { return r.field.frame.blur_px; }},
        {"mtf_difference_rms", "its MTF at the pixels' Nyquist frequency, rms", "",
         [](const MeasuredRung& r) { return r.field.frame.mtf; }},
        {"exposure_ev", "exposure, rms", "EV", [](const MeasuredRung& r) { return r.field.frame.exposure_ev; }},
        {"ciede2000_mean", "colour, CIEDE2000", "", [](const MeasuredRung& r) { return r.picture.ciede2000.bias; }},
        {"flip", "FLIP", "", [](const MeasuredRung& r) { return r.picture.flip.bias; }}};
    return errors;
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
                         .has_common_y = false,
                         .frame = {180.0, 190.0}};
    const std::vector<MeasuredRung> all = applicable(rungs);
    for (const char* key : {"image_rms_px", "exposure_ev", "ciede2000_mean"}) {
        grid.panels.push_back(pareto_chart(error_named(key), all, noise));
    }
    return draw::chart_grid_svg(grid);
}

findings::Findings tradeoff_findings(const std::vector<MeasuredScene>& scenes) {
    Sufficient suffices = what_suffices(scenes);
    findings::Findings found{.subjects_title = "Pictures and models", .subjects = std::move(suffices.subjects)};
    found.not_shown = {
        "The MTF is by rays, without diffraction, and like place and width of images that of the plane of focus.",
        "Errors of CIEDE2000 are those of a picture's blocks, and miss noise that is the same all over it.",
        "Costs are this machine's and differ from run to run; errors do not."};
    Json table = Json::list();
    for (const MeasuredScene& measured : scenes) {
        add_checks(measured, found.checks);
        found.subjects.push_back(scene_subject(measured));
        std::ranges::move(field_plots(measured.scene, applicable(measured.rungs)), std::back_inserter(found.plots));
        std::ranges::copy(measured.scene.files, std::back_inserter(found.inputs));
        Json json = tradeoff_json(measured.rungs);
        json["name"] = measured.scene.name;
        table.push_back(std::move(json));
    }
    std::ranges::move(model_subjects(scenes), std::back_inserter(found.subjects));
    found.tables = {{"tradeoff", std::move(table)}, {"suffices", std::move(suffices.rows)}};
    return found;
}

}  // namespace lensproof::studies
