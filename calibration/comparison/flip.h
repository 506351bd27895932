// calibration/comparison/flip.h — FLIP, the difference that one sees who flips between two pictures.
#pragma once
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// 0.7 m away from a display of 3840 px on 0.7 m: what FLIP's authors take, pixels a degree.
inline constexpr double kFlipPixelsPerDegree = 67.02064327658226;

/// FLIP at each pixel, 0 to 1, of two pictures alike in linear light, clipped to what a display shows (Andersson,
/// Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for Alternating Images",
/// 2020). Their picture's value is the mean over pixels.
///
/// Pixels beyond the frame are the nearest within.
formats::Image flip_low_range(const formats::Image& a, const formats::Image& b, double pixels_per_degree, int threads);

/// The exposures that HDR-FLIP looks at, EV added to the pictures.
struct FlipExposures {
    double first_ev = 0.0;
    double last_ev = 0.0;
    int count = 2;
};

/// From that which brings the brightest pixel of the reference to 0.85 of what the tone curve makes of infinity's
/// white, to that which brings the median there; steps of one EV at most.
FlipExposures flip_exposures(const formats::Image& reference);

/// The same for pictures of a high dynamic range, `a` the reference: at each pixel the largest over exposures, each
/// mapped by Narkowicz's fit of the ACES tone curve (Andersson, Nilsson, Shirley and Akenine-Möller, "Visualizing
/// Errors in Rendered High Dynamic Range Images", 2021).
formats::Image flip_high_range(const formats::Image& a, const formats::Image& b, double pixels_per_degree,
                               const FlipExposures& exposures, int threads);

}  // namespace lensproof::calibration
