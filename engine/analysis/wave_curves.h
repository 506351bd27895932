// engine/analysis/wave_curves.h — what diffraction makes of a lens's fields, sampled for plots: wavefronts, PSF and
// MTF.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "engine/analysis/lens_analysis.h"
#include "engine/base/vec.h"

namespace lensproof::analysis {

// Fields are in degrees.

/// A square grid of values over a square: row by row from low y to high y.
struct SquareMap {
    std::size_t size = 0;          // pixels a side
    double half_width = 0.0;       // from the middle to the outer edge of the outermost pixels
    std::vector<double> values{};  // size²; NaN: masked
};

/// Optical path differences (waves) over the exit pupil.
struct FieldWavefront {
    double field_deg = 0.0;
    double wavelength_nm = 0.0;
    SquareMap opd_waves{};  // the half width in units of the pupil coordinate
    double rms_waves = 0.0;
    double peak_to_valley_waves = 0.0;
    std::vector<double> zernike_waves{};  // coefficients in Noll's order, from piston on
    std::string remark{};                 // why there is no map where light arrives
};

/// The image of a point, in units of the peak of a perfect lens with the same pupil; the half width in µm.
struct PsfMap {
    double field_deg = 0.0;
    SquareMap intensity{};
    double strehl = 0.0;
    std::string remark{};  // why there is no picture where light arrives: "aberrations too large for the grid"
};

/// Modulation against spatial frequency (cycles/mm) at one field.
struct FieldMtf {
    double field_deg = 0.0;
    std::vector<Vec2d> tangential{};
    std::vector<Vec2d> sagittal{};
    std::string remark{};  // beside the field in the legend: "by rays"; without curves, why there are none
};

/// Modulation against field (degrees) at one spatial frequency.
struct FrequencyMtf {
    double cycles_per_mm = 0.0;
    std::vector<Vec2d> tangential{};
    std::vector<Vec2d> sagittal{};
};

struct WaveCurves {
    std::vector<FieldWavefront> wavefronts;
    std::vector<PsfMap> psfs;
    std::vector<FieldMtf> mtf;            // with diffraction
    std::vector<FieldMtf> geometric_mtf;  // by rays alone
    std::vector<Vec2d> diffraction_limit;
    std::vector<FrequencyMtf> mtf_over_field;
};

/// The middle of a field's point image, by FFT, wide enough for the rays and for some rings of Airy's disc.
PsfMap psf_map(const PolychromaticField& field, double field_deg);

/// A field's MTF with diffraction, or by rays where the path differences are too steep to be sampled: there the two
/// agree.
FieldMtf resolved_mtf(const PolychromaticField& field, std::span<const double> frequencies, double field_deg);

/// That of the same pupil without aberration: without curves where that cannot be sampled.
FieldMtf diffraction_limited_mtf(const PolychromaticField& field, std::span<const double> frequencies,
                                 double field_deg);

/// Frequencies in even steps up to where the field is cut off, at most 100 cycles/mm.
std::vector<double> shown_frequencies(const PolychromaticField& axis);

/// Fields on up to `threads` threads (0: one a core).
WaveCurves wave_curves(const optics::Lens& lens, const AnalysisSettings& settings, int threads = 0);

}  // namespace lensproof::analysis
