// calibration/detection/pixel_noise.h — how noisy a picture is near a chart's points.
#pragma once
#include <vector>

#include "calibration/detection/refine.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// How far around a point its neighbourhood reaches: half the distance to the nearest other point that was found, and
/// no more than tells anything more, px.
int neighbourhood_px(const ChartPoints& points, std::size_t i);

/// The standard deviation of a pixel's noise, the median over the points found; 0 where there are none.
///
/// In each neighbourhood the median absolute response to Immerkaer's mask (1996, "Fast noise variance estimation"),
/// which light that changes evenly does not touch; a second time without the pixels whose neighbours differ by more
/// than noise, which are edges. Compression that smooths noise away is not seen through, and clipped pixels, which have
/// none, do not count.
double pixel_noise(const formats::Image& image, int channel, const ChartPoints& points);

/// The same over the whole of a picture that shows no chart.
double pixel_noise(const formats::Image& image, int channel);

}  // namespace lensproof::calibration
