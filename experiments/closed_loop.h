// experiments/closed_loop.h — a measured render against the rays of the lens that made it.
#pragma once
#include <string>
#include <vector>

#include "calibration/profile/profile.h"
#include "experiments/experiment.h"
#include "experiments/verdict.h"

namespace lensproof {

/// The checks that `limits` ask for. A curve that was not measured makes its check inconclusive.
std::vector<Check> closed_loop_checks(const std::string& subject, const std::string& label, const Profile& measured,
                                      const Profile& traced, const ClosedLoopLimits& limits);

}  // namespace lensproof
