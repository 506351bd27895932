// experiments/draw/analysis_curves.h — the curves of a lens's analysis that rays alone give, as its plots show them.
#pragma once
#include <vector>

#include "engine/analysis/lens_analysis.h"
#include "experiments/draw/analysis_plots.h"

namespace lensproof::draw {

/// Of fields without light there is the angle alone.
struct AnalysisCurves {
    std::vector<FieldFans> fans;
    std::vector<FieldCurve> field_curves;
    std::vector<WavelengthCurve> longitudinal;
    std::vector<WavelengthCurve> lateral_colour;
    std::vector<Vec2d> airy_radius;  // µm over the field in degrees
    std::vector<double> defocus_mm;  // of the spots' planes
    std::vector<FieldSpots> spots;
    std::vector<FieldBrightness> illumination;
};

AnalysisCurves analysis_curves(const optics::Lens& lens, const analysis::AnalysisSettings& settings);

}  // namespace lensproof::draw
