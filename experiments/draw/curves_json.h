// experiments/draw/curves_json.h — the numbers behind the plots of an analysis, for programs.
#pragma once

#include "engine/base/json.h"
#include "experiments/draw/analysis_curves.h"
#include "experiments/draw/wave_curves.h"

namespace lensproof::draw {

/// Every number that the plots show, keyed with its unit; of PSFs, which are pictures, what they are called.
Json curves_json(const AnalysisCurves& curves, const WaveCurves& waves);

}  // namespace lensproof::draw
