// calibration/picture/picture_traits.h — what a picture of a chart is like: its tones, its noise and its blur.
#pragma once
#include <optional>

#include "calibration/detection/refine.h"
#include "engine/base/json_archive.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// Of one channel in linear light, full scale 1, near the chart's points.
struct PictureTraits {
    double white = 0.0;  // the median over the points of the bright tone around each,
    double black = 0.0;  // and of the dark one
    double noise = 0.0;  // standard deviation of a pixel
    /// Standard deviation of the edges' blur, the pixel's own box in it, px. None where no point has an edge that is
    /// well above the noise (a chart of dots that are smaller than the blur).
    std::optional<double> blur_px;
    /// How the light changes over the chart: the gradient of ln(white) on it, per mm, vignetting taken out. Filled in
    /// by `measure` once that is known (calibration/light/light_gradient.h); none where the chart shows too little
    /// white.
    std::optional<Vec2d> light_gradient_per_mm = std::nullopt;
};

/// Tones are the 5th and the 95th percentile of the pixels nearer to a point than half the distance to the next one.
/// Noise is `pixel_noise` (calibration/detection/pixel_noise.h). Blur follows from the steepest pixels there: across an
/// edge of a Gaussian's blur σ between tones that are C apart, two pixels that are 2 px apart differ by up to C erf(1 /
/// √2 σ). Noise and blur are within a quarter for σ from 0.4 to 2.5 px and points 30 px apart
/// (tests/calibration/self_test/self_test_test.cpp).
///
/// None when no point was found.
std::optional<PictureTraits> picture_traits(const formats::Image& image, int channel, const ChartPoints& points);

void fields(JsonArchive& json, PictureTraits& traits);

}  // namespace lensproof::calibration
