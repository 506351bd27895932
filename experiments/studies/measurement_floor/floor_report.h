// experiments/studies/measurement_floor/floor_report.h — the measurement's floor as checks, as charts, and as a report.
#pragma once
#include <map>
#include <string>

#include "engine/base/json.h"
#include "experiments/runner/run_experiment.h"
#include "experiments/studies/measurement_floor/measure_floor.h"

namespace lensproof::studies {

MeasurementFloor run_measurement_floor(const runner::Experiment& experiment, const runner::RunSettings& settings,
                                       const runner::RunProgress& progress);

/// The charts' bytes (SVG) by the names that the JSON uses, one for each sweep.
std::map<std::string, std::string> floor_charts(const MeasurementFloor& floor);

/// In the schema of experiments/draw/report/report.h, each sweep a subject, with "sweeps" besides:
///     [{"id", "title", "setting", "parameter", "unit", "error", "error_unit",
///       "curves": [{"label", "points": [{"value", "error", "sigma", "found_percent", "trials", "failed"}]}]}]
Json floor_report_json(const runner::Experiment& experiment, const MeasurementFloor& floor,
                       const runner::RunSettings& settings);

}  // namespace lensproof::studies
