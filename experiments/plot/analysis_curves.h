// experiments/plot/analysis_curves.h — the curves and pictures of a lens's analysis, as its plots show them.
#pragma once
#include <nlohmann/json.hpp>

#include "engine/analysis/lens_analysis.h"
#include "engine/io/image.h"
#include "experiments/plot/analysis_plots.h"

namespace lensproof {

/// All that the plots show. Of fields without light there is the angle alone.
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

/// The curves that rays alone give.
AnalysisCurves analysis_curves(const Lens& lens, const AnalysisSettings& settings);

/// What diffraction gives.
struct WaveCurves {
    std::vector<FieldWavefront> wavefronts;
    std::vector<PsfMap> psfs;
    std::vector<FieldMtf> mtf;            // with diffraction
    std::vector<FieldMtf> geometric_mtf;  // by rays alone
    std::vector<Vec2d> diffraction_limit;
    std::vector<FrequencyMtf> mtf_over_field;
};

/// Fields on up to `threads` threads (0: one a core).
WaveCurves wave_curves(const Lens& lens, const AnalysisSettings& settings, int threads = 0);

/// Every number that the plots show, keyed with its unit; of PSFs, which are pictures, what they are called.
nlohmann::ordered_json curves_json(const AnalysisCurves& curves, const WaveCurves& waves);

/// "psf_12deg.exr"
std::string psf_file_name(const PsfMap& psf);

/// The PSF as a picture of one channel "Y", y upwards, in units of the perfect lens's peak; `pixel_um`, `field_deg` and
/// `strehl` are its attributes. Nothing where there is no PSF.
std::optional<Image> psf_image(const PsfMap& psf);

/// The drawings by file name.
std::map<std::string, std::string> analysis_drawings(const PlotHeading& heading, Projection projection,
                                                     const AnalysisCurves& curves, const WaveCurves& waves);

}  // namespace lensproof
