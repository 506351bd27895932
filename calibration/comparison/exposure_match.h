// calibration/comparison/exposure_match.h — exposure and white balance of one picture brought to another's.
#pragma once
#include <string>
#include <vector>

#include "calibration/comparison/overlap.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// b · gain stands for a, channel by channel, in linear light.
struct ExposureMatch {
    bool is_matched = false;      // else pictures are taken as they are
    std::vector<Estimate> gains;  // of a's channels, as found; none where there is no light to tell
    std::string reason;           // of what was done, in words
};

/// Less is no difference in exposure, EV.
inline constexpr double kLeastExposure_ev = 0.01;

/// From where on a channel's values may be clipped, in linear light; infinite for files that clip nothing.
struct ClippedFrom {
    double a;
    double b;
};

/// The ratio of the channels' sums over the pixels in common that are clipped in none: an estimate that noise in either
/// picture does not draw (a regression's gain falls with the noise of its regressor). No gain is applied where none is
/// off by three standard errors and by `kLeastExposure_ev`.
ExposureMatch match_exposure(const formats::Image& a, const formats::Image& b, const Overlap& overlap,
                             const ClippedFrom& clipped);

/// Multiplies the picture by the gains where they are to be matched.
void apply(const ExposureMatch& match, formats::Image& image);

}  // namespace lensproof::calibration
