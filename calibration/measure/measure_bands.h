// calibration/measure/measure_bands.h — the chromatic shift between pictures of one scene at different wavelengths.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibration/chromatic/chromatic_shift.h"
#include "calibration/chromatic/mosaic.h"
#include "calibration/profile/profile.h"
#include "engine/formats/image/image.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// A picture as it is measured.
struct BandPlanes {
    formats::Image image;  // linear light, of one channel or of several that are alike
    /// Of a raw mosaic the colours that were mixed for it.
    std::vector<MosaicColour> colours = {};
};

/// A picture taken in a narrow band.
struct BandPicture {
    double wavelength_nm = 0.0;
    std::string name;
    std::function<BandPlanes()> load;  // may throw InputError
};

/// Camera, chart and focus are the same in every picture.
struct BandInput {
    std::string name;  // of the profile
    std::vector<BandPicture> bands;
    double reference_wavelength_nm = 0.0;  // one of the bands'
    /// Not set: dark discs are found without knowing their chart, and matched by their place.
    std::optional<scene::Chart> chart;
    /// The optical centre, px; it may lie outside a cropped picture. Not set: the picture's middle.
    std::optional<Vec2d> centre_px;
    ProfileSource source;  // `images` is filled in
    std::optional<double> pixel_pitch_um;
};

/// For each band but the reference's the curves of the chromatic shift (radial and tangential) and the terms behind
/// them (calibration/chromatic/chromatic_shift.h); the channel is the wavelength, "450nm".
///
/// Of a crop that does not hold the optical centre, the model's terms trade against each other, above all radial
/// terms against the translation; there the means over the points (kMeanShiftTerms) are what is known.
///
/// Colours of a mosaic that do not agree where things are, by 0.05 px and three standard errors in the mean, are not
/// mixed: the strongest is measured by, alone, and a warning of the profile says so.
///
/// A disc's centroid moves with perspective by as much in every band, so it drops out of the difference.
/// Throws InputError for fewer than two bands, bands of the same wavelength, none at the reference's, pictures of
/// different sizes, and where too few points are found in common.
Profile measure_bands(const BandInput& input);

/// Adds the curves and terms of one channel's pairs to a profile.
/// Throws InputError as `fit_chromatic_shift` does.
void add_chromatic_shift(Profile& profile, const std::string& label, const std::vector<ChromaticPair>& pairs,
                         const Vec2d& centre_px);

/// What a channel is called in names of curves: "450nm" of a spectral layer "S0.450nm", else its own name.
std::string channel_label(const std::string& channel);

}  // namespace lensproof::calibration
