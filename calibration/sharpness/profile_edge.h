// calibration/sharpness/profile_edge.h — an edge as a profile lists it.
#pragma once
#include <optional>
#include <string>

#include "calibration/sharpness/slanted_edge.h"
#include "engine/base/json_node.h"

namespace lensproof::calibration {

struct ProfileEdge {
    std::string image;
    EdgeMtf edge;
};

/// `image`, `centre_px`, `normal_deg` (from dark to bright, from +x towards +y), `rise_px`, `bend_px`; for MTF50 and
/// MTF10, where they were reached, `mtf50_cycles_per_px`, `mtf50_standard_error`, `mtf50_lower_95`, `mtf50_upper_95`,
/// and `mtf50_cycles_per_mm` where the pixel pitch is known; `curve`: `step_cycles_per_px`, `mtf`, `standard_error`.
Json to_json(const ProfileEdge& edge, std::optional<double> pixel_pitch_um);

/// A frequency's keys as above, `name` in front of each; nothing where there is none.
void add_mtf_frequency(Json& json, const std::string& name, const std::optional<MtfFrequency>& frequency,
                       std::optional<double> pixel_pitch_um);
std::optional<MtfFrequency> parse_mtf_frequency(const JsonNode& node, const std::string& name);

/// Throws InputError as JsonNode says.
ProfileEdge parse_edge(const JsonNode& node);

}  // namespace lensproof::calibration
