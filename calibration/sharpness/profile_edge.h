// calibration/sharpness/profile_edge.h — an edge as a profile lists it.
#pragma once
#include <optional>
#include <string>

#include "calibration/sharpness/slanted_edge.h"
#include "engine/base/json_archive.h"

namespace lensproof::calibration {

struct ProfileEdge {
    std::string image;
    EdgeMtf edge;
};

/// `image`, `centre_px`, `normal_deg` (from dark to bright, from +x towards +y), `rise_px`, `bend_px`, `length_px`,
/// `width_px`; for MTF50 and MTF10, where they were reached, `mtf50_cycles_per_px`, `mtf50_standard_error`,
/// `mtf50_lower_95`, `mtf50_upper_95`, and `mtf50_cycles_per_mm` where the pixel pitch is known; `curve`:
/// `step_cycles_per_px`, `mtf`, `standard_error`.
void fields(JsonArchive& json, ProfileEdge& edge, const std::optional<double>& pixel_pitch_um);

/// A frequency's keys as above, `name` in front of each; nothing where there is none.
void mtf_fields(JsonArchive& json, const std::string& name, std::optional<MtfFrequency>& frequency,
                const std::optional<double>& pixel_pitch_um);

}  // namespace lensproof::calibration
