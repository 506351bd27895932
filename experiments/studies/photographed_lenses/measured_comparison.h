// experiments/studies/photographed_lenses/measured_comparison.h — one lens against one photographed lens, with a
// verdict.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "calibration/photographed/imaged_field.h"
#include "calibration/photographed/lens_agreement.h"
#include "calibration/photographed/photographed_lens.h"
#include "engine/base/json.h"
#include "engine/optics/lens.h"
#include "experiments/findings/verdict.h"

namespace lensproof::studies {

/// The largest rms difference of distortion between a prescription and photographs of its product, as a fraction of the
/// half-diagonal: where the right ones within it exceed the wrong ones by most (experiments/README.md).
inline constexpr double kLimitFraction = 1e-3;

/// From here on, as a fraction of the half-diagonal, what both lenses image says something of the lens.
inline constexpr double kLeastReachFraction = 0.8;

struct Judgement {
    double limit_um = 0.0;
    findings::Verdict verdict = findings::Verdict::inconclusive;
    std::string reason;  // a sentence
};

struct CornerLight {
    double f_number = 0.0;
    double measured = 0.0;            // over that on the axis, at the half-diagonal
    std::optional<double> simulated;  // nothing where the lens does not open so far
};

struct MeasuredComparison {
    calibration::PhotographedLens photographed;
    std::string lens;
    std::optional<calibration::DistortionAgreement> distortion{};
    std::optional<calibration::LateralColourAgreement> lateral_colour{};
    std::vector<CornerLight> vignetting{};
    double photographed_departure_um = 0.0;  // from a lens without distortion, rms: what there is to tell lenses by
    double simulated_departure_um = 0.0;
    Judgement judgement{};
};

/// What is to be seen of the agreement. PASS: within the limit, where a lens without distortion would be at least twice
/// as far. FAIL: beyond the limit. INCONCLUSIVE: within it where a lens without distortion would be nearly as near, so
/// that many wrong ones are, too; nothing or less than `kLeastReachFraction` to compare over; and beyond the limit for
/// a fisheye, since lensfun's fisheyes are 0.15 to 0.5 mm off lenses that are right.
Judgement judge(const calibration::PhotographedLens& photographed,
                const std::optional<calibration::DistortionAgreement>& distortion);

/// Distortion and its verdict alone, of a field that reaches the photographed half-diagonal where the lens does.
MeasuredComparison compare_distortion(const std::string& lens, const calibration::PhotographedLens& photographed,
                                      const calibration::ImagedField& field);

/// Focused on infinity by first-order data, whatever distance the table has behind the lens: photographs were focused.
optics::Lens focused_for_photographs(const optics::Lens& lens);

/// All there is, focused so: `wavelength_nm` in place of the camera's response, which leaves lateral colour out. Throws
/// InputError for a wavelength that a glass does not cover.
MeasuredComparison compare_with_photographed(const optics::Lens& lens,
                                             const calibration::PhotographedLens& photographed,
                                             std::optional<double> wavelength_nm);

/// {"lens", "measured": {…}, "distortion": {…}, "chromatic_shift": {…}, "vignetting": […]}.
Json comparison_json(const MeasuredComparison& comparison);

/// Pixels of a picture of 24 megapixels, 6000 along the long side of 3:2, on the photographed lens's sensor, µm.
double usual_pixel_um(const calibration::PhotographedLens& photographed);

}  // namespace lensproof::studies
