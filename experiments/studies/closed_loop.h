// experiments/studies/closed_loop.h — a measured render against the rays of the lens that made it.
#pragma once
#include <string>
#include <vector>

#include "calibration/profile/profile.h"
#include "experiments/runner/experiment.h"
#include "experiments/runner/verdict.h"

namespace lensproof::studies {

/// The checks that `limits` ask for. A curve that was not measured makes its check inconclusive.
std::vector<runner::Check> closed_loop_checks(const std::string& subject, const std::string& label,
                                              const calibration::Profile& measured, const calibration::Profile& traced,
                                              const runner::ClosedLoopLimits& limits);

}  // namespace lensproof::studies
