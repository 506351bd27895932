// calibration/comparison/registration.h — where the places of one picture lie in another.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "calibration/comparison/overlap.h"
#include "calibration/comparison/warp.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

struct WarpParameter {
    std::string name;
    Estimate estimate;
};

/// How likely it is that the pictures show the same, or why that cannot be told.
enum class Likeness { alike, unlike, untold };

struct Registration {
    WarpModel model = WarpModel::none;
    Warp warp;                              // from places of `a` to places of `b`
    std::vector<WarpParameter> parameters;  // the model's, with one standard error
    /// What 8 × 8 tiles of the frame, each by itself, would still be shifted by: root mean square of a component, px.
    /// Noise is in it, and all that the model cannot express. NaN where nothing was to be seen.
    double residual_px = std::nan("");
    Likeness likeness = Likeness::untold;
    double correlation = 0.0;  // of the pictures' detail, at the resolution where it is largest
    double overlap = 1.0;      // fraction of the frame
    std::string reason;        // of the model, in words
};

/// What moves no corner as far as that is no warp: to resample a picture costs more.
inline constexpr double kLeastMove_px = 0.01;

/// Registers two pictures alike, in linear light, by their luminance, compressed as v / (v + typical value) and
/// smoothed by σ = 1 px: where b shows what a shows at x.
///
/// Starts from no shift, the peak of the phase correlation, or of turned and scaled copies, whichever fits best, and
/// goes from coarse to fine by least squares of contrast, offset and warp (warp_fit.h). Between pixels `b` is a cubic
/// B-spline: OpenCV's findTransformECC takes bilinear interpolation in steps of 1/32 px, which draws its answer by 0.01
/// to 0.02 px.
///
/// `wanted`, or where it is none the model by Schwarz's criterion (1978) over what the tiles say, at at most two
/// million pixels: the one with the least n ln χ² + k ln n; and none where it moves no corner by `kLeastMove_px`.
Registration register_pictures(const formats::Image& a, const formats::Image& b, std::optional<WarpModel> wanted,
                               int threads);

/// `b` as seen from `a`'s places, and which of them it covers; black elsewhere. As it is where the warp is none.
struct WarpedPicture {
    formats::Image image;
    Overlap overlap;
};
WarpedPicture warped(formats::Image b, const Registration& registration, int threads);

}  // namespace lensproof::calibration
