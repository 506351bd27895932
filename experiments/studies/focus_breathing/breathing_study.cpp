#include "experiments/studies/focus_breathing/breathing_study.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/analysis/lens_analysis.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/optics/focus.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"

namespace lensproof::studies {

namespace {

struct Breathing {
    std::string name;
    std::string lens;
    std::vector<std::string> zoom;  // "": the first position
    std::vector<double> distances_mm;
    double field_deg = 0.0;
    std::optional<double> at_most_percent;
};

constexpr const char* kBreathingStep = "focus-breathing";

// What a step's result follows from: settings, and files by their bytes.
findings::StepInput input_of(const Breathing& asked, const std::string& zoom, double distance_mm) {
    return {.settings = {{"zoom", zoom}, {"distance_mm", fmt::format("{}", distance_mm)}, {"field", asked.field_deg}},
            .files = formats::files_of_lens(asked.lens)};
}

/// The height at which the chief ray of the field arrives, mm: the picture's size, as the scene is seen from the pupil.
double image_height(const Breathing& asked, const std::string& zoom, double distance_mm) {
    const optics::Lens lens =
        optics::focused_at(formats::load_lens(asked.lens, {.indices = {}, .zoom = zoom, .glasses = {}}), distance_mm);
    const analysis::LensAnalysis analysis = analysis::analyze_lens(lens, {.wavelengths_nm = {spectral::kLineD},
                                                                          .reference_wavelength_nm = spectral::kLineD,
                                                                          .fields_deg = {asked.field_deg},
                                                                          .object_distance = distance_mm});
    const std::optional<Vec2d> point = analysis.fields.front().chief_ray_point;
    return point ? point->y : std::nan("");  // none: the check is not decided
}

findings::Findings carry_out(const Breathing& asked, const findings::RunSettings& settings,
                             const findings::RunProgress& progress) {
    findings::Findings found{.subjects_title = "Lenses"};
    draw::PlotChart chart{.title = asked.name,
                          .caption = fmt::format("Growth of the picture at {:g}°", asked.field_deg),
                          .x = {.label = "Focus distance", .unit = "mm", .scale = draw::AxisScale::logarithmic},
                          .y = {.label = "Larger by", .unit = "%", .holds_zero = true}};
    Json rows = Json::list();
    for (const std::string& zoom : asked.zoom) {
        progress(asked.name + " " + zoom, static_cast<double>(chart.curves.size()) / asked.zoom.size());
        draw::ChartCurve curve{.label = zoom, .colour = draw::series_colour(chart.curves.size())};
        curve.marker = draw::CurveMarker::dot;
        double first = 0.0;
        for (const double distance : asked.distances_mm) {
            const double height = settings.steps.step(kBreathingStep, input_of(asked, zoom, distance),
                                                      [&] { return image_height(asked, zoom, distance); });
            first = distance == asked.distances_mm.front() ? height : first;
            const double percent = 100.0 * (height / first - 1.0);
            curve.points.push_back({distance, percent});
            rows.push_back(
                {{"name", asked.name}, {"zoom", zoom}, {"distance_mm", distance}, {"larger_by_percent", percent}});
        }
        if (asked.at_most_percent) {
            found.checks.push_back({.id = fmt::format("{}-{}", asked.name, zoom),
                                    .group = asked.name,
                                    .subject = asked.name,
                                    .label = zoom + ": breathing to the nearest distance",
                                    .value = std::abs(curve.points.back().y),
                                    .unit = "%",
                                    .limit = *asked.at_most_percent});
        }
        chart.curves.push_back(std::move(curve));
    }
    constexpr draw::ChartSize kSize{};
    found.subjects = {{.id = asked.name, .kind = "lens", .label = asked.lens}};
    found.subjects.front().pictures.push_back({.name = asked.name + "/breathing.svg",
                                               .caption = "How the picture grows",
                                               .width = kSize.width,
                                               .height = kSize.height,
                                               .bytes = draw::chart_svg(chart, kSize)});
    found.tables = {{"focus_breathing", std::move(rows)}};
    found.inputs = formats::files_of_lens(asked.lens);
    return found;
}

}  // namespace

std::vector<findings::Study> read_focus_breathing(findings::ExperimentFile& file) {
    std::vector<findings::Study> studies;
    for (TomlTable& table : file.tables("focus_breathing")) {
        Breathing asked{.name = findings::read_name(table), .lens = formats::read_lens_name(table)};
        file.add_subject(table, "name", asked.name);
        asked.zoom = table.has("zoom") ? table.texts("zoom") : std::vector<std::string>{""};
        asked.distances_mm = table.any_numbers("focus_distances_mm");
        asked.field_deg = table.number("field_deg", {.min = 0.01, .max = 89.0});
        asked.at_most_percent = table.optional_number("at_most_percent", kPositive);
        table.finish();
        studies.push_back({asked.name, [asked](const auto& settings, const auto& progress, const auto&) {
                               return carry_out(asked, settings, progress);
                           }});
    }
    return studies;
}

}  // namespace lensproof::studies
