// experiments/measurement_floor/floor_report.h — the measurement's floor as checks, as charts, and as a report.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "experiments/measurement_floor/measure_floor.h"
#include "experiments/run_experiment.h"

namespace lensproof {

MeasurementFloor run_measurement_floor(const Experiment& experiment, const RunSettings& settings,
                                       const RunProgress& progress);

/// The charts' bytes (SVG) by the names that the JSON uses, one for each sweep.
std::map<std::string, std::string> floor_charts(const MeasurementFloor& floor);

/// In the schema of experiments/report/report.h, each sweep a subject, with "sweeps" besides:
///     [{"id", "title", "setting", "parameter", "unit", "error", "error_unit",
///       "curves": [{"label", "points": [{"value", "error", "sigma", "found_percent", "trials", "failed"}]}]}]
nlohmann::ordered_json floor_report_json(const Experiment& experiment, const MeasurementFloor& floor,
                                         const RunSettings& settings);

}  // namespace lensproof
