// experiments/studies/measurement_floor/floor_study.h — [measurement_floor]: what the measurement gets wrong by itself,
// as findings.
#pragma once
#include "experiments/findings/study.h"
#include "experiments/studies/measurement_floor/measure_floor.h"

namespace lensproof::studies {

/// `pictures`, `trials`, `sweeps` and `detectors` of FloorSettings, all optional, and `name` where a file has several
/// such tables. Each sweep becomes a subject; a table
/// "sweeps" has the numbers:
///     [{"id", "title", "setting", "parameter", "unit", "error", "error_unit",
///       "curves": [{"label", "points": [{"value", "error", "sigma", "found_percent", "trials", "failed"}]}]}]
std::vector<findings::Study> read_measurement_floor(findings::ExperimentFile& file);

/// The sweep's curves in words, and as a chart.
findings::Subject sweep_subject(const FloorSweep& sweep);

}  // namespace lensproof::studies
