// experiments/studies/sweeps/sweep_charts.h — a sweep's values as small multiples.
#pragma once
#include <vector>

#include "experiments/findings/findings.h"
#include "experiments/studies/sweeps/sweep_study.h"

namespace lensproof::studies {

/// A drawing of each family of quantities: curves along the axis `over`, one of each value of the axis `curves`, in a
/// panel of each combination of the axes that remain.
std::vector<findings::Picture> sweep_charts(const Sweep& sweep, const std::vector<SweepValue>& values);

}  // namespace lensproof::studies
