// experiments/plot/curves_json.h — the numbers behind the plots of an analysis, for programs.
#pragma once
#include <nlohmann/json.hpp>

#include "experiments/plot/analysis_curves.h"
#include "experiments/plot/wave_curves.h"

namespace lensproof {

/// Every number that the plots show, keyed with its unit; of PSFs, which are pictures, what they are called.
nlohmann::ordered_json curves_json(const AnalysisCurves& curves, const WaveCurves& waves);

}  // namespace lensproof
