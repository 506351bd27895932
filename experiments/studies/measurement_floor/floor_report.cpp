#include "experiments/studies/measurement_floor/floor_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/base/infinity.h"
#include "engine/base/json.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"
#include "experiments/runner/provenance.h"
#include "experiments/runner/report_content.h"

namespace lensproof::studies {

namespace {
constexpr draw::ChartSize kChartSize{.width = 760.0, .height = 420.0};

void append(MeasurementFloor& floor, MeasurementFloor part) {
    std::ranges::move(part.sweeps, std::back_inserter(floor.sweeps));
    std::ranges::move(part.checks, std::back_inserter(floor.checks));
}

/// What the curves do not show: pictures or sets of them that gave no number. Empty where all did.
std::string failures_in_words(const FloorSweep& sweep) {
    std::string words;
    for (const FloorCurve& curve : sweep.curves) {
        std::string places;
        for (const FloorPoint& point : curve.points) {
            if (point.failed > 0) {
                places += fmt::format("{}{} of {} at {:g}{}{}", places.empty() ? "" : ", ", point.failed, point.trials,
                                      point.value, sweep.unit.empty() ? "" : " ", sweep.unit);
            }
        }
        if (!places.empty()) {
            words += fmt::format("{}{}: {}", words.empty() ? "Failed: " : "; ", curve.label, places);
        }
    }
    return words;
}

std::string sweep_chart(const FloorSweep& sweep) {
    draw::PlotChart chart{.title = sweep.title,
                          .caption = sweep.setting,
                          .x = {.label = sweep.parameter, .unit = sweep.unit},
                          .y = {.label = sweep.error, .unit = sweep.error_unit, .scale = draw::AxisScale::logarithmic}};
    constexpr std::array kMarkers = {draw::CurveMarker::dot,      draw::CurveMarker::ring,    draw::CurveMarker::square,
                                     draw::CurveMarker::triangle, draw::CurveMarker::diamond, draw::CurveMarker::plus,
                                     draw::CurveMarker::cross};
    for (std::size_t i = 0; i < sweep.curves.size(); ++i) {
        draw::ChartCurve curve{.label = sweep.curves[i].label,
                               .points = {},
                               .colour = draw::series_colour(i),
                               .marker = kMarkers.at(i % kMarkers.size())};
        std::ranges::transform(sweep.curves[i].points, std::back_inserter(curve.points), [](const FloorPoint& point) {
            return Vec2d{point.value, point.error};
        });
        chart.curves.push_back(std::move(curve));
    }
    if (sweep.target) {
        chart.references.push_back(
            {.direction = draw::ReferenceDirection::horizontal, .at = *sweep.target, .label = "asked"});
    }
    chart.note = failures_in_words(sweep);
    return draw::chart_svg(chart, kChartSize);
}

Json sweep_json(const FloorSweep& sweep) {
    Json json{
        {"id", sweep.id},     {"title", sweep.title}, {"setting", sweep.setting},      {"parameter", sweep.parameter},
        {"unit", sweep.unit}, {"error", sweep.error}, {"error_unit", sweep.error_unit}};
    for (const FloorCurve& curve : sweep.curves) {
        Json points = Json::list();
        for (const FloorPoint& point : curve.points) {
            points.push_back({{"value", point.value},
                              {"error", point.error},
                              {"sigma", point.sigma},
                              {"found_percent", point.found_percent},
                              {"trials", point.trials},
                              {"failed", point.failed}});
        }
        json["curves"].push_back({{"label", curve.label}, {"points", std::move(points)}});
    }
    return json;
}

/// A curve in words: "0.004 … 0.03 px; fewest found: 87 % at 4 %".
std::string in_words(const FloorSweep& sweep, const FloorCurve& curve) {
    double least = kInfinity;
    double most = 0.0;
    const FloorPoint* fewest = nullptr;
    for (const FloorPoint& point : curve.points) {
        if (std::isfinite(point.error)) {
            least = std::min(least, point.error);
            most = std::max(most, point.error);
        }
        if (fewest == nullptr || point.found_percent < fewest->found_percent) {
            fewest = &point;
        }
    }
    const std::string lost = fewest == nullptr || fewest->found_percent > 99.95
                                 ? ""
                                 : fmt::format("; fewest found: {:.3g} % at {:g}{}{}", fewest->found_percent,
                                               fewest->value, sweep.unit.empty() ? "" : " ", sweep.unit);
    return most > 0.0 ? fmt::format("{:.2g} … {:.2g} {}{}", least, most, sweep.error_unit, lost) : "nothing found";
}

Json subject_json(const FloorSweep& sweep) {
    Json json{{"id", sweep.id}, {"kind", sweep.setting}, {"label", sweep.title}};
    for (const FloorCurve& curve : sweep.curves) {
        json["facts"].push_back({{"label", curve.label}, {"value", in_words(sweep, curve)}});
    }
    if (const std::string failures = failures_in_words(sweep); !failures.empty()) {
        json["facts"].push_back({{"label", "not measured"}, {"value", failures}});
    }
    json["pictures"] = {{{"name", sweep.id + ".svg"},
                         {"caption", fmt::format("{} against {}", sweep.error, sweep.parameter)},
                         {"width", static_cast<int>(kChartSize.width)},
                         {"height", static_cast<int>(kChartSize.height)}}};
    return json;
}

}  // namespace

MeasurementFloor run_measurement_floor(const runner::Experiment& experiment, const runner::RunSettings& settings,
                                       const runner::RunProgress& progress) {
    const FloorSettings& wanted = *experiment.measurement_floor;
    MeasurementFloor floor;
    append(floor, measure_detectors(wanted, settings.seed, settings.threads, progress));
    append(floor, measure_quantities(wanted, settings.seed, settings.threads, progress));
    append(floor, measure_models(wanted, settings.seed, settings.threads, progress));
    append(floor, measure_intervals(wanted, settings.seed, settings.threads, progress));
    return floor;
}

std::map<std::string, std::string> floor_charts(const MeasurementFloor& floor) {
    std::map<std::string, std::string> charts;
    for (const FloorSweep& sweep : floor.sweeps) {
        charts[sweep.id + ".svg"] = sweep_chart(sweep);
    }
    return charts;
}

Json floor_report_json(const runner::Experiment& experiment, const MeasurementFloor& floor,
                       const runner::RunSettings& settings) {
    const auto passed = std::ranges::count_if(
        floor.checks, [](const runner::Check& check) { return check.verdict() == runner::Verdict::pass; });
    Json report{{"schema", "lensproof-report/1"},
                {"title", experiment.title},
                {"summary", fmt::format("{} {} of {} checks hold.", experiment.summary, passed, floor.checks.size())},
                {"verdict", runner::verdict_name(runner::overall(floor.checks))},
                {"subjects_title", "Sweeps"},
                {"checks", Json::list()},
                {"subjects", Json::list()}};
    std::ranges::transform(floor.checks, std::back_inserter(report["checks"]), runner::check_json);
    std::ranges::transform(floor.sweeps, std::back_inserter(report["subjects"]), subject_json);
    std::ranges::transform(floor.sweeps, std::back_inserter(report["sweeps"]), sweep_json);
    report["provenance"] = runner::provenance_json({experiment.file}, settings);
    report["reproduce"] =
        fmt::format("./lensproof run {} --seed {}", runner::portable_path(experiment.file), settings.seed);
    return report;
}

}  // namespace lensproof::studies
