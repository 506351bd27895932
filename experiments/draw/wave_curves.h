// experiments/draw/wave_curves.h — what diffraction makes of a lens's fields: wavefronts, PSF and MTF, as plots show
// them.
#pragma once
#include <vector>

#include "engine/analysis/lens_analysis.h"
#include "experiments/draw/analysis_plots.h"

namespace lensproof::draw {

struct WaveCurves {
    std::vector<FieldWavefront> wavefronts;
    std::vector<PsfMap> psfs;
    std::vector<FieldMtf> mtf;            // with diffraction
    std::vector<FieldMtf> geometric_mtf;  // by rays alone
    std::vector<Vec2d> diffraction_limit;
    std::vector<FrequencyMtf> mtf_over_field;
};

/// Fields on up to `threads` threads (0: one a core).
WaveCurves wave_curves(const optics::Lens& lens, const analysis::AnalysisSettings& settings, int threads = 0);

}  // namespace lensproof::draw
