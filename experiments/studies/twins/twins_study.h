// experiments/studies/twins/twins_study.h — [[twins]]: photos of a chart rendered again through a prescription, from
// the same place, and what remains between the two.
#pragma once
#include "experiments/findings/study.h"

namespace lensproof::studies {

/// Of photos that a [[photos]] of the file measures. In report.json, under "twins", of each: `name`, `photos`, `lens`,
/// `f_number`, `pixel_pitch_um`, `axis_px`, `changes` (in words), `displacements_px` (`all`, `lens`, `lens_sigma`,
/// `chart`, `chart_sigma`, `rest`, `expected`; root mean squares of a coordinate) and of each of its `pictures` the
/// fractions of the contrast that a pixel differs by (calibration/twins/pixel_account.h).
std::vector<findings::Study> read_twins(findings::ExperimentFile& file);

}  // namespace lensproof::studies
