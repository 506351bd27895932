// experiments/studies/cameras/comparisons.h — [[comparisons]]: two measured cameras set against each other in one
// curve.
#pragma once
#include "experiments/findings/study.h"

namespace lensproof::studies {

/// The cameras are those that the studies before it measure.
std::vector<findings::Study> read_comparisons(findings::ExperimentFile& file);

}  // namespace lensproof::studies
