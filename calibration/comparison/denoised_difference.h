// calibration/comparison/denoised_difference.h — what differs between two pictures beyond their noise.
#pragma once
#include "calibration/comparison/overlap.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// The difference of two pictures' luminances, b − a in linear light, with its noise taken out.
struct DenoisedDifference {
    formats::Image map;           // one channel; 0 where there is no more than noise, and where nothing is in common
    double noise = 0.0;           // standard deviation of the difference's noise, a pixel's, the median over tones
    double noise_fraction = 0.0;  // fraction of the pixels in which no more than noise was seen
};

/// The noise is that of the difference itself, in which a scene that both show alike is gone: in each of 16 classes of
/// equally many pixels by `a`'s tone, the median absolute response to Immerkaer's mask (1996). A pixel's mean m over a
/// Gaussian window of σ = 2 px, of which noise that is independent from pixel to pixel has the variance
/// s² = noise² / (4 π σ²), becomes m max(0, 1 − (2 s / m)²): the empirical Wiener filter, with a threshold of two
/// standard deviations. Noise that neighbours share (demosaiced, compressed, resampled pixels) is underestimated.
DenoisedDifference denoised_difference(const formats::Image& a, const formats::Image& b, const Overlap& overlap);

}  // namespace lensproof::calibration
