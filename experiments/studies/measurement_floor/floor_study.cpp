#include "experiments/studies/measurement_floor/floor_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/base/infinity.h"
#include "engine/base/json.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"

namespace lensproof::studies {

namespace {
constexpr draw::ChartSize kChartSize{.width = 760.0, .height = 420.0};

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

}  // namespace

findings::Subject sweep_subject(const FloorSweep& sweep) {
    findings::Subject subject{.id = sweep.id, .kind = sweep.setting, .label = sweep.title};
    for (const FloorCurve& curve : sweep.curves) {
        subject.facts.push_back({curve.label, in_words(sweep, curve)});
    }
    if (const std::string failures = failures_in_words(sweep); !failures.empty()) {
        subject.facts.push_back({"not measured", failures});
    }
    subject.pictures = {{.name = sweep.id + ".svg",
                         .caption = fmt::format("{} against {}", sweep.error, sweep.parameter),
                         .width = static_cast<int>(kChartSize.width),
                         .height = static_cast<int>(kChartSize.height),
                         .bytes = sweep_chart(sweep)}};
    return subject;
}

namespace {

findings::Findings floor_findings(const FloorSettings& wanted, const findings::RunSettings& settings,
                                  const findings::RunProgress& progress) {
    findings::Findings found{.counts_checks = true, .subjects_title = "Sweeps"};
    Json sweeps;
    for (const auto measure : {measure_detectors, measure_quantities, measure_models, measure_intervals}) {
        MeasurementFloor part = measure(wanted, settings, progress);
        std::ranges::move(part.checks, std::back_inserter(found.checks));
        std::ranges::transform(part.sweeps, std::back_inserter(found.subjects), sweep_subject);
        std::ranges::transform(part.sweeps, std::back_inserter(sweeps), sweep_json);
    }
    found.tables = {{"sweeps", std::move(sweeps)}};
    return found;
}

}  // namespace

std::vector<findings::Study> read_measurement_floor(findings::ExperimentFile& file) {
    static const std::string kKind = "measurement_floor";
    std::vector<findings::Study> studies;
    for (TomlTable& table : file.tables(kKind)) {
        FloorSettings wanted;
        const std::string name = findings::name_or(table, kKind);
        wanted.sweeps = findings::names_of(table, "sweeps", detector_sweeps());
        wanted.detectors = findings::names_of(table, "detectors", floor_detectors());
        wanted.pictures = table.integer_or("pictures", wanted.pictures, 1, 1000);
        wanted.trials = table.integer_or("trials", wanted.trials, 20, 100000);
        table.finish();
        file.add_subject(table, "name", name);  // as its subjects' ids, which begin with it
        studies.push_back({name, [wanted = std::move(wanted), name](const findings::RunSettings& settings,
                                                                    const findings::RunProgress& progress,
                                                                    const findings::Findings&) {
                               return findings::told_apart(floor_findings(wanted, settings, progress), name, kKind);
                           }});
    }
    return studies;
}

}  // namespace lensproof::studies
