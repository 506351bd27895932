// calibration/sharpness/profile_star.h — a Siemens star as a profile lists it.
#pragma once
#include <optional>
#include <string>

#include "calibration/sharpness/siemens_star.h"
#include "engine/base/json_archive.h"

namespace lensproof::calibration {

struct ProfileStar {
    std::string image;
    StarMtf star;
};

/// `image`, `centre_px`, `outline` (`centre_px`, `half_axes_px`: the longer first, `angle_deg` of the longer) and
/// `segments`, each with `frequency_deg` (the direction along which black and white alternate there, from +x towards
/// +y), `side_deg` (where it lies, seen from the centre), `contrast` and `contrast_standard_error` ((white − black) /
/// (white + black) of the sectors), MTF50 and MTF10 as edges have them (calibration/sharpness/profile_edge.h), and
/// `curve`: `cycles_per_px`, `mtf`, `standard_error`.
void fields(JsonArchive& json, ProfileStar& star, const std::optional<double>& pixel_pitch_um);
void fields(JsonArchive& json, StarSegment& segment, const std::optional<double>& pixel_pitch_um);

}  // namespace lensproof::calibration
