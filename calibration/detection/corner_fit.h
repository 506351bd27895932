// calibration/detection/corner_fit.h — where two edges cross, from a model of the light around the crossing.
#pragma once
#include <limits>
#include <opencv2/core.hpp>
#include <optional>

#include "engine/base/vec.h"

namespace lensproof::calibration {

/// What a corner fit starts from.
struct CornerStart {
    Vec2d corner_px;      // to a pixel or so
    Vec2d along_first;    // directions of the two edges that cross there; one square long, px
    Vec2d along_second;   //
    int half_window = 0;  // px
    /// How far from the edges a marker stands in each white square, in squares; what it may darken is left out.
    double clear_squares = std::numeric_limits<double>::infinity();
    double line_squares = 0.0;  // above 0: two dark lines of this width cross on a bright ground, not two edges
};

struct CornerFit {
    Vec2d corner_px;
    Vec2d standard_error_px;
};

/// The corner of a checkerboard, by least squares (Levenberg-Marquardt) of
///     I(x, y) = a + g·(x, y) + b erf(d₁ / √2σ) erf(d₂ / √2σ)
/// over the (2 h + 1)² pixels around the start, where d₁, d₂ are the distances from the two edges: straight lines, or
/// parabolas where the window is wide enough to tell (h ≥ 6; a fisheye bends edges by 0.05 px and more within one). σ
/// is the edges' blur, the pixel's own box in it; g takes up uneven light. Blur of any kind that looks the same after a
/// half turn leaves the corner where it is, and so does ink that spreads.
///
/// Where dark lines cross, each factor is 1 − ½ [erf((d + w/2) / √2σ) − erf((d − w/2) / √2σ)] for their width w.
///
/// `plane` is CV_32F in linear light; where the window reaches beyond it, the part inside has to do. None where the fit
/// does not settle on an edge-like corner near the start (within half the window).
/// Errors on synthetic pictures: tests/calibration/detection/corner_accuracy_test.cpp.
///
/// `plane` is a picture that was blurred by a Gaussian of `plane_blur_px`. The standard errors are the least squares'
/// own for noise in the picture, before that blur, of standard deviation 1, independent from pixel to pixel: with
/// weights w of the blurred pixels in a coordinate, the root of Σ (G w)², G the blur.
std::optional<CornerFit> fit_corner(const cv::Mat& plane, double plane_blur_px, const CornerStart& start);

}  // namespace lensproof::calibration
