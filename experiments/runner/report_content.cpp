#include "experiments/runner/report_content.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "experiments/runner/provenance.h"

namespace lensproof::runner {

namespace {
/// .s0 … .s6 of the report's page, on white.
constexpr std::array kSubjectColours = {"#0072b2", "#c77b00", "#b5548a", "#3d9fd8", "#8a8200", "#009e73", "#d55e00"};

Json check_json(const findings::Check& check) {
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
            {"expect", findings::expectation_name(check.expectation)},
            {"target", check.expectation == findings::Expectation::within ? Json(check.target) : Json(nullptr)},
            {"verdict", findings::verdict_name(check.verdict())},
            {"floor", check.floor ? *check.floor : Json(nullptr)},
            {"explanation", explanation}};
}

Json provenance_json(std::vector<std::filesystem::path> inputs, const Json& settings) {
    Json provenance{{"program", "lensproof"},
                    {"version", program_version()},
                    {"commit", source_commit()},
                    {"libraries", library_versions()}};
    provenance["settings"] = settings;
    std::ranges::sort(inputs);
    inputs.erase(std::unique(inputs.begin(), inputs.end()), inputs.end());
    for (const std::filesystem::path& input : inputs) {
        provenance["inputs"].push_back({{"file", portable_path(input)}, {"sha256", sha256(input)}});
    }
    return provenance;
}

Json picture_json(const findings::Picture& picture) {
    Json json{
        {"name", picture.name}, {"caption", picture.caption}, {"width", picture.width}, {"height", picture.height}};
    if (!picture.layers.empty()) {
        json["label"] = picture.label;
    }
    for (const findings::PictureLayer& layer : picture.layers) {
        json["layers"].push_back({{"name", layer.name},
                                  {"label", layer.label},
                                  {"kind", layer.kind == findings::LayerKind::difference ? "difference" : "picture"}});
    }
    if (picture.points) {
        json["points"] = *picture.points;
    }
    return json;
}

Json subject_json(const findings::Subject& subject) {
    Json json{{"id", subject.id}, {"kind", subject.kind}, {"label", subject.label}};
    for (const findings::Fact& fact : subject.facts) {
        json["facts"].push_back({{"label", fact.label}, {"value", fact.value}});
    }
    if (subject.focal_length_px) {
        json["focal_length_px"] = {{"value", subject.focal_length_px->first},
                                   {"sigma", subject.focal_length_px->second}};
    }
    for (const findings::Picture& picture : subject.pictures) {
        json["pictures"].push_back(picture_json(picture));
    }
    if (const auto& points = subject.points) {
        json["points"] = {{"centre_px", Json::list({points->centre_px.x, points->centre_px.y})},
                          {"half_diagonal_px", points->half_diagonal_px},
                          {"rms_px", points->rms_px}};
    }
    for (const findings::Picture& picture : subject.worst) {
        json["worst"].push_back({{"name", picture.name}, {"caption", picture.caption}});
    }
    return json;
}

Json series_json(const findings::Series& series) {
    Json json{{"label", series.label},          {"subject", series.subject},
              {"style", series.style},          {"x", series.curve.image_height},
              {"y", series.curve.value},        {"lower", series.curve.lower_95},
              {"upper", series.curve.upper_95}, {"covered_to", series.curve.covered_image_height}};
    if (series.floor) {
        json["floor"] = *series.floor;
    }
    return json;
}

struct Abscissa {
    const char* key;
    const char* label;
    const char* unit;
};

Abscissa abscissa(findings::PlotOver over) {
    switch (over) {
        case findings::PlotOver::azimuth:
            return {"azimuth", "azimuth about the centre, from right to down", "°"};
        case findings::PlotOver::residual:
            return {"residual", "residual of a coordinate, over its rms", ""};
        case findings::PlotOver::image_height:
            break;
    }
    return {"image_height", "image height (of the half-diagonal)", ""};
}

Json plot_json(const findings::Plot& plot) {
    const Abscissa over = abscissa(plot.over);
    Json json{{"id", plot.id},         {"title", plot.title},     {"subtitle", plot.subtitle}, {"over", over.key},
              {"x_label", over.label}, {"y_label", plot.y_label}, {"x_unit", over.unit},       {"y_unit", plot.y_unit}};
    for (const findings::Series& series : plot.series) {
        json["series"].push_back(series_json(series));
    }
    if (plot.limit) {
        json["limit"] = *plot.limit;
    }
    return json;
}

std::string summary_of(const Experiment& experiment, const findings::Findings& found) {
    if (!found.counts_checks) {
        return experiment.summary;
    }
    const auto passed = std::ranges::count(found.checks, findings::Verdict::pass, &findings::Check::verdict);
    return fmt::format("{} {} of {} checks hold.", experiment.summary, passed, found.checks.size());
}

}  // namespace

Json report_json(const Experiment& experiment, const findings::Findings& found, const findings::RunSettings& settings) {
    ReportHead head{
        .title = experiment.title,
        .summary = summary_of(experiment, found),
        .settings = {{"seed", settings.seed}},
        .reproduce = fmt::format("./lensproof run {} --seed {}", portable_path(experiment.file), settings.seed)};
    if (settings.quality == findings::Quality::draft) {
        head.summary += fmt::format(
            " A draft: pictures of scenes have 1/{} of the width and height and 1/{} of the "
            "samples of each pixel, one at least.",
            findings::kDraftShrinks, findings::kDraftSamplesOver);
        head.settings["quality"] = "draft";
        head.reproduce += " --quality draft";
    }
    if (!experiment.only.empty()) {
        head.settings["only"] = experiment.only;
        head.reproduce += fmt::format(" --only {}", fmt::join(experiment.only, " "));
    }
    return report_json(head, found);
}

Json report_json(const ReportHead& head, const findings::Findings& found) {
    Json report{{"schema", "lensproof-report/1"},
                {"title", head.title},
                {"summary", head.summary},
                {"verdict", findings::verdict_name(findings::overall(found))}};
    for (const findings::Failure& failure : found.failures) {
        report["failures"].push_back(
            {{"study", failure.study}, {"message", failure.message}, {"exit_status", failure.is_of_input ? 2 : 3}});
    }
    if (found.subjects_title != findings::kUsualSubjects) {
        report["subjects_title"] = found.subjects_title;
    }
    report["checks"] = Json::list();
    report["subjects"] = Json::list();
    std::ranges::transform(found.checks, std::back_inserter(report["checks"]), check_json);
    std::ranges::transform(found.subjects, std::back_inserter(report["subjects"]), subject_json);
    for (const findings::Chapter& chapter : found.chapters) {
        report["chapters"].push_back(
            {{"title", chapter.title}, {"text", chapter.text}, {"subjects", chapter.subjects}});
    }
    for (const auto& [key, table] : found.tables) {
        report[key] = table;
    }
    if (!found.plots.empty()) {
        report["plots"] = Json::list();
        report["maps"] = Json::list();
    }
    for (const findings::Plot& plot : found.plots) {
        if (!plot.series.empty()) {
            report["plots"].push_back(plot_json(plot));
        }
    }
    for (const findings::Map& map : found.maps) {
        report["maps"].push_back({{"name", map.name}, {"subject", map.subject}, {"caption", map.caption}});
    }
    for (const std::string& sentence : found.not_shown) {
        report["not_shown"].push_back(sentence);
    }
    report["provenance"] = provenance_json(found.inputs, head.settings);
    report["reproduce"] = head.reproduce;
    return report;
}

std::map<std::string, std::string> report_pictures(const findings::Findings& found) {
    std::map<std::string, std::string> pictures;
    std::map<std::string, std::string> colours;
    for (std::size_t i = 0; i < found.subjects.size(); ++i) {
        const findings::Subject& subject = found.subjects[i];
        colours.emplace(subject.id, kSubjectColours.at(i % kSubjectColours.size()));
        for (const findings::Picture& picture : subject.pictures) {
            const auto keep = [&](const std::string& name, const std::string& bytes) {
                if (!bytes.empty()) {
                    pictures[name] = bytes;
                }
            };
            keep(picture.name, picture.bytes);
            for (const findings::PictureLayer& layer : picture.layers) {
                keep(layer.name, layer.bytes);
            }
        }
        for (const findings::Picture& picture : subject.worst) {
            pictures[picture.name] = picture.bytes;
        }
    }
    std::map<std::string, std::vector<const draw::FrameMap*>> frames;
    for (const findings::Map& map : found.maps) {
        frames[map.frame.label].push_back(&map.frame);
    }
    for (const findings::Map& map : found.maps) {
        const draw::AxisRange range = draw::common_range(frames.at(map.frame.label));
        pictures[map.name] = draw::frame_map_svg(map.frame, range, colours.at(map.subject));
    }
    return pictures;
}

}  // namespace lensproof::runner
