// experiments/studies/cameras/closed_loop.h — a measured render against the rays of the lens that made it.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "calibration/profile/curve_difference.h"
#include "calibration/profile/profile.h"
#include "experiments/findings/verdict.h"

namespace lensproof::studies {

/// How far a measured render may be from what the lens's own rays say; each that is stated becomes a check.
struct ClosedLoopLimits {
    std::optional<double> distortion_rms_px;
    std::optional<double> distortion_largest_px;
    std::optional<double> vignetting_percent;  // of the relative illumination, largest over the covered heights
    std::optional<double> chromatic_shift_px;  // red and blue against green, largest over the covered heights
};

/// The checks that `limits` ask for. A curve that was not measured makes its check inconclusive.
std::vector<findings::Check> closed_loop_checks(const std::string& subject, const std::string& label,
                                                const calibration::Profile& measured,
                                                const calibration::Profile& traced, const ClosedLoopLimits& limits);

}  // namespace lensproof::studies
