// experiments/draw/curves_json.h — the numbers behind the plots of an analysis, for programs.
#pragma once

#include "engine/analysis/ray_curves.h"
#include "engine/analysis/wave_curves.h"
#include "engine/base/json.h"

namespace lensproof::draw {

/// Every number that the plots show, keyed with its unit; of PSFs, which are pictures, what they are called.
Json curves_json(const analysis::RayCurves& curves, const analysis::WaveCurves& waves);

}  // namespace lensproof::draw
