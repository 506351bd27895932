// experiments/cli/analysis_output.h — what `lensproof analyze` found, for programs and for people.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "engine/analysis/lens_analysis.h"

namespace lensproof {

/// The contract's JSON: what does not exist is null.
nlohmann::ordered_json analysis_json(const Lens& lens, const AnalysisSettings& settings, const LensAnalysis& analysis);

/// The same as tables to read.
std::string analysis_text(const Lens& lens, const AnalysisSettings& settings, const LensAnalysis& analysis);

}  // namespace lensproof
