// experiments/cli/analysis_output.h — what `lensproof analyze` found, for programs and for people.
#pragma once
#include <string>
#include <vector>

#include "engine/analysis/lens_analysis.h"
#include "engine/analysis/veiling_glare.h"
#include "engine/base/json.h"
#include "engine/optics/finding.h"

namespace lensproof::cli {

/// The contract's JSON: what does not exist is null.
Json analysis_json(const optics::Lens& lens, const analysis::AnalysisSettings& settings,
                   const analysis::LensAnalysis& analysis);

/// The same as tables to read.
std::string analysis_text(const optics::Lens& lens, const analysis::AnalysisSettings& settings,
                          const analysis::LensAnalysis& analysis);

/// The member `veiling_glare`, and a line to read.
Json veiling_glare_json(const analysis::VeilingGlare& glare);
std::string veiling_glare_text(const analysis::VeilingGlare& glare);

}  // namespace lensproof::cli
