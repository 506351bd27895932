#include "experiments/studies/edge_diffraction/edge_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "engine/base/input_error.h"
#include "engine/base/order_statistics.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/heat_map.h"
#include "experiments/draw/palette.h"

namespace lensproof::studies {

namespace {

std::string id_of(const EdgeSetting& setting) {
    std::string id = setting.blades == 0 ? "circle" : fmt::format("{}-blades", setting.blades);
    if (setting.curvature > 0.0) {
        id += fmt::format("-round-{:g}", setting.curvature);
    }
    return fmt::format("{}-{}-f{:g}", std::filesystem::path(setting.lens).stem().string(), id, setting.f_number);
}

std::string label_of(const EdgeSetting& setting) {
    const std::string stop =
        setting.blades == 0 ? "a circle"
                            : fmt::format("{} {}blades", setting.blades, setting.curvature > 0.0 ? "rounded " : "");
    return fmt::format("{}, {} at f/{:g}", setting.lens, stop, setting.f_number);
}

/// A number that rays and waves lead to, and its standard error by how the batches differ.
struct Compared {
    double value = 0.0;
    double standard_error = 0.0;
};

template <class Of>
Compared compared(const EdgeDiffraction& found, const Of& of) {
    const auto count = static_cast<double>(found.batches.size());
    double mean = 0.0;
    double squares = 0.0;
    for (const EdgeRays& batch : found.batches) {
        mean += of(batch) / count;
        squares += of(batch) * of(batch) / count;
    }
    const double variance = count > 1.0 ? std::max(0.0, squares - mean * mean) / (count - 1.0) : 0.0;
    return {of(found.rays), std::sqrt(variance)};
}

/// Rays over waves, less one, of the octave that is farthest off.
Compared worst_octave(const EdgeDiffraction& found) {
    const auto off = [&](const EdgeRays& rays, std::size_t i) {
        return rays.profile.octaves[i] / found.wave.octaves[i] - 1.0;
    };
    std::size_t worst = 0;
    for (std::size_t i = 1; i < kOctaves.size(); ++i) {
        worst = std::abs(off(found.rays, i)) > std::abs(off(found.rays, worst)) ? i : worst;
    }
    return compared(found, [&](const EdgeRays& rays) { return off(rays, worst); });
}

Compared slope_off(const EdgeDiffraction& found) {
    return compared(found, [&](const EdgeRays& rays) { return rays.profile.slope() / found.wave.slope() - 1.0; });
}

Compared energy_off(const EdgeDiffraction& found) {
    return compared(found, [&](const EdgeRays& rays) { return rays.profile.energy / found.wave.energy - 1.0; });
}

/// Degrees.
Compared worst_turn(const EdgeDiffraction& found) {
    const std::vector<Streak>& streaks = found.rays.streaks;
    const auto worst = std::ranges::max_element(streaks, {}, [](const Streak& s) { return std::abs(s.turn_deg); });
    const auto index = static_cast<std::size_t>(worst - streaks.begin());
    return compared(found, [&](const EdgeRays& rays) { return rays.streaks[index].turn_deg; });
}

/// Of the light, in the middle of the streaks.
Compared near_streaks_off(const EdgeDiffraction& found) {
    return compared(found, [&](const EdgeRays& rays) { return rays.profile.near_streaks - found.wave.near_streaks; });
}

std::string signed_percent(const Compared& off) {
    return fmt::format("{:+.2f} ± {:.2f} %", 100.0 * off.value, 100.0 * off.standard_error);
}

/// The wave's map, the rays' map: the left half is the one, the right half the other.
findings::Picture map_drawing(const EdgeSetting& setting, const EdgeDiffraction& found) {
    const auto side = static_cast<std::size_t>(found.ray_map.side);
    draw::HeatMap map{.columns = side,
                      .rows = side,
                      .values = {},
                      .x = {-kMapRadius, kMapRadius},
                      .y = {-kMapRadius, kMapRadius},
                      .label = "log₁₀ of the irradiance over the light's"};
    for (std::size_t i = 0; i < side * side; ++i) {
        map.values.push_back((i % side < side / 2 ? found.wave_map : found.ray_map).values[i]);
    }
    std::vector<double> ordered(found.wave_map.values.begin(), found.wave_map.values.end());
    const double brightest = quantile(ordered, 0.999);
    constexpr double kDecades = 4.0;
    map.range = {brightest - kDecades, brightest};
    draw::PlotChart chart{.title = label_of(setting),
                          .caption = "Left by waves, right by rays",
                          .x = {.label = "x", .unit = "λN"},
                          .y = {.label = "y", .unit = "λN"},
                          .map = std::move(map),
                          .has_equal_scales = true};
    constexpr draw::ChartSize kSize{.width = 620.0, .height = 560.0};
    return {.name = id_of(setting) + "/map.svg",
            .caption = "Diffracted light about the image of a star: left by waves, right by rays",
            .width = kSize.width,
            .height = kSize.height,
            .bytes = draw::chart_svg(chart, kSize)};
}

findings::Picture profile_drawing(const EdgeSetting& setting, const EdgeDiffraction& found) {
    draw::PlotChart chart{
        .title = label_of(setting),
        .caption = "Mean irradiance around the image of a star",
        .x = {.label = "Distance from the image", .unit = "λN", .scale = draw::AxisScale::logarithmic},
        .y = {.label = "Irradiance over the light's", .scale = draw::AxisScale::logarithmic},
        .curves = {{.label = "by waves", .points = found.wave.rings, .colour = draw::series_colour(0)},
                   {.label = "by rays",
                    .points = found.rays.profile.rings,
                    .colour = draw::series_colour(1),
                    .line = draw::CurveLine::none,
                    .marker = draw::CurveMarker::ring}}};
    constexpr draw::ChartSize kSize{.width = 620.0, .height = 420.0};
    return {.name = id_of(setting) + "/profile.svg",
            .caption = "All azimuths together, in narrow rings",
            .width = kSize.width,
            .height = kSize.height,
            .bytes = draw::chart_svg(chart, kSize)};
}

findings::Subject subject_of(const EdgeSetting& setting, const EdgeDiffraction& found) {
    findings::Subject subject{
        .id = id_of(setting),
        .kind = "stop",
        .label = label_of(setting),
        .facts = {{"λN", fmt::format("{:.3g} µm", 1e3 * airy_mm(setting))},
                  {"worst octave from 5 to 100 λN, rays against waves", signed_percent(worst_octave(found))},
                  {"logarithmic slope, rays and waves",
                   fmt::format("{:.3f} and {:.3f}", found.rays.profile.slope(), found.wave.slope())},
                  {"light from 5 λN on, rays against waves", signed_percent(energy_off(found))}},
        .pictures = {map_drawing(setting, found), profile_drawing(setting, found)}};
    if (!found.rays.streaks.empty()) {
        subject.facts.push_back({"streaks", fmt::format("{}, within {:.3f}° of the edges' normals",
                                                        found.rays.streaks.size(), std::abs(worst_turn(found).value))});
        subject.facts.push_back({"light within a λN of the streaks' middles, by rays and waves",
                                 fmt::format("{:.1f} and {:.1f} %", 100.0 * found.rays.profile.near_streaks,
                                             100.0 * found.wave.near_streaks)});
    }
    return subject;
}

Json setting_json(const EdgeSetting& setting, const EdgeDiffraction& found) {
    Json turns = Json::list();
    std::ranges::transform(found.rays.streaks, std::back_inserter(turns), &Streak::turn_deg);
    return {{"lens", setting.lens},
            {"f_number", setting.f_number},
            {"blades", setting.blades},
            {"curvature", setting.curvature},
            {"octaves_airy", std::vector<double>(kOctaves.begin(), kOctaves.end())},
            {"rays", found.rays.profile.octaves},
            {"wave", found.wave.octaves},
            {"rays_slope", found.rays.profile.slope()},
            {"wave_slope", found.wave.slope()},
            {"energy_ratio", found.rays.profile.energy / found.wave.energy},
            {"energy_ratio_standard_error", energy_off(found).standard_error},
            {"streaks_deg", std::move(turns)},
            {"rays_near_streaks", found.rays.profile.near_streaks},
            {"wave_near_streaks", found.wave.near_streaks}};
}

constexpr const char* kEdgeStep = "edge-diffraction";

findings::StepInput input_of(const EdgeSetting& setting, const findings::RunSettings& run) {
    return {.settings = {{"lens", setting.lens},
                         {"f_number", setting.f_number},
                         {"blades", setting.blades},
                         {"curvature", setting.curvature},
                         {"paths", setting.paths},
                         {"seed", run.seed}},
            .files = formats::files_of_lens(setting.lens)};
}

std::vector<EdgeSetting> read_settings(TomlTable& table, findings::ExperimentFile& file) {
    EdgeSetting setting{.lens = formats::read_lens_name(table),
                        .curvature = table.number_or("curvature", 0.0, {.min = 0.0, .max = 1.0}),
                        .paths = table.integer_or("paths", EdgeSetting{}.paths, 1000, 360'000)};
    std::vector<EdgeSetting> settings;
    for (const double blades : table.numbers("blades", 0, {.min = 0.0, .max = 64.0})) {
        if (blades != std::floor(blades) || blades == 1.0 || blades == 2.0) {
            table.fail("blades", fmt::format("has {}, expected whole numbers: 0 for a circle, or 3 to 64", blades));
        }
        for (const double f_number : table.numbers("f_numbers", 0, {.min = 0.1, .max = 1000.0})) {
            setting.blades = static_cast<int>(blades);
            setting.f_number = f_number;
            file.add_subject(table, "blades", id_of(setting));
            settings.push_back(setting);
        }
    }
    table.finish();
    return settings;
}

}  // namespace

std::vector<findings::Check> edge_checks(const MeasuredEdges& measured) {
    std::vector<findings::Check> checks;
    for (const auto& [setting, found] : measured) {
        const findings::Check common{.group = label_of(setting), .subject = id_of(setting)};
        const auto add = [&checks, &common](const std::string& what, const std::string& label, const Compared& off,
                                            double scale, const std::string& unit, double limit,
                                            const std::string& explanation) {
            findings::Check check = common;
            check.id = common.subject + "-" + what;
            check.label = label;
            check.value = scale * std::abs(off.value);
            check.sigma = scale * off.standard_error;
            check.unit = unit;
            check.limit = limit;
            check.explanation = explanation;
            checks.push_back(std::move(check));
        };
        add("octaves", "worst octave from 5 to 100 λN", worst_octave(found), 100.0, "%", 10.0,
            "Rays over waves, a mean over an octave of distance, which averages the rings.");
        add("slope", "logarithmic slope", slope_off(found), 100.0, "%", 5.0,
            "Of the irradiance over the distance, by least squares over the octaves.");
        add("energy", "light from 5 λN on", energy_off(found), 100.0, "%", 5.0,
            "Up to 100 λN; it begins as the mean of 5 to 7 λN, since a sharp cut swings with the rings.");
        if (!found.rays.streaks.empty()) {
            add("streaks", "streaks from the edges' normals", worst_turn(found), 1.0, "°", 0.2,
                "The mean azimuth of each, beyond 20 λN, the worst of them.");
            add("streak-width", "light in the middle of the streaks", near_streaks_off(found), 100.0, "% of the light",
                20.0,
                "Of the light beyond 20 λN, what lies within a λN of the middle of a streak, rays less waves. Rays add "
                "the lens's aberrations to what the edge's length spreads; waves hardly do where they are below a "
                "quarter of a wave.");
        }
    }
    return checks;
}

findings::Findings edge_findings(const MeasuredEdges& measured) {
    findings::Findings found{.checks = edge_checks(measured),
                             .subjects_title = "Stops",
                             .not_shown = {"The stop is taken to be a thin black screen."}};
    Json table = Json::list();
    for (const auto& [setting, edges] : measured) {
        found.subjects.push_back(subject_of(setting, edges));
        std::ranges::move(formats::files_of_lens(setting.lens), std::back_inserter(found.inputs));
        table.push_back(setting_json(setting, edges));
    }
    found.tables = {{"edge_diffraction", std::move(table)}};
    return found;
}

std::vector<findings::Study> read_edge_diffraction(findings::ExperimentFile& file) {
    std::vector<findings::Study> studies;
    for (TomlTable& table : file.tables("edge_diffraction")) {
        for (const EdgeSetting& setting : read_settings(table, file)) {
            const auto measured = [setting](const findings::RunSettings& run, const findings::RunProgress& progress) {
                progress(label_of(setting), 0.0);
                return run.steps.step(kEdgeStep, input_of(setting, run),
                                      [&] { return measure_edges(setting, run.seed); });
            };
            const auto carry_out = [setting, measured](const findings::RunSettings& run,
                                                       const findings::RunProgress& progress,
                                                       const findings::Findings&) {
                return edge_findings({{setting, measured(run, progress)}});
            };
            studies.push_back({id_of(setting), carry_out, [setting, measured](const findings::RunSettings& run) {
                                   return std::vector<findings::PlannedStep>{
                                       {kEdgeStep, label_of(setting), input_of(setting, run), 8.0, measured}};
                               }});
        }
    }
    return studies;
}

}  // namespace lensproof::studies
