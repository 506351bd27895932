// experiments/studies/tradeoff/ring_study.h — [[analysis_rings]]: what an analysis of a lens with fewer rings of rays
// gets wrong, and what it costs.
#pragma once
#include <vector>

#include "engine/analysis/lens_analysis.h"
#include "engine/base/json_archive.h"
#include "experiments/findings/study.h"

namespace lensproof::studies {

/// Against the analysis with `kManyRings`: root mean square over fields and wavelengths.
struct RingError {
    int rings = 0;
    double spot_um = 0.0;          // of the spot's rms radius
    double centroid_um = 0.0;      // of where the spot is
    double wavefront_waves = 0.0;  // of its rms
    double milliseconds = 0.0;     // of one core, for the whole analysis
};
void fields(JsonArchive& json, RingError& error);

inline constexpr int kManyRings = 64;

std::vector<RingError> ring_errors(const optics::Lens& lens, const analysis::AnalysisSettings& settings,
                                   const std::vector<int>& rings);

/// The tables: lens, f_number (optional), fields_deg. Findings: a subject for each lens, with its errors over the time,
/// and the table "analysis_rings", of {"lens", "rings": [{"rings", "spot_um", "centroid_um", "wavefront_waves",
/// "milliseconds"}]}.
std::vector<findings::Study> read_analysis_rings(findings::ExperimentFile& file);

}  // namespace lensproof::studies
