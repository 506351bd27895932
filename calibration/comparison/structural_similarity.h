// calibration/comparison/structural_similarity.h — SSIM, how alike two pictures' structures are.
#pragma once
#include "calibration/comparison/overlap.h"

namespace lensproof::calibration {

/// Half the window's side, px: pixels that near the frame's edge have no window of their own.
inline constexpr int kSsimReach_px = 5;

/// SSIM at each pixel (Wang, Bovik, Sheikh and Simoncelli 2004, eq. 13):
///
///     (2 μa μb + C1) (2 σab + C2) / ((μa² + μb² + C1) (σa² + σb² + C2)),   C1 = 0.01², C2 = 0.03², full scale 1,
///
/// of `a` and `b` alike, as displays show them (sRGB's values). Means and (co)variances are those of a Gaussian window
/// of 11 × 11 px and σ = 1.5 px, normalised by its sum, not by one less. Colours: the mean over the channels.
///
/// Borders: windows that reach beyond the frame are not to be counted: a mean is over `shrunk(…, kSsimReach_px)`. That
/// is scikit-image's structural_similarity(gaussian_weights=True, sigma=1.5, use_sample_covariance=False). OpenCV's
/// quality module counts windows over mirrored pixels too, and comes to other numbers in the third digit.
formats::Image structural_similarity(const formats::Image& a, const formats::Image& b, int threads);

}  // namespace lensproof::calibration
