// calibration/comparison/noise_ratio.h — PSNR, the peak signal-to-noise ratio.
#pragma once
#include "calibration/comparison/overlap.h"

namespace lensproof::calibration {

/// The root mean square difference of two pictures alike, over all channels of the pixels in common.
Estimate rms_difference(const formats::Image& a, const formats::Image& b, const Overlap& overlap);

/// PSNR = 20 lg(1 / rms), dB, full scale 1 (ITU-T J.340 with full scale for the peak); infinite where the pictures are
/// equal. The standard error is carried over to first order.
Estimate peak_signal_to_noise_db(const Estimate& rms);

}  // namespace lensproof::calibration
