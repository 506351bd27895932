// calibration/lines/find_lines.h — the long edges of a picture, which may be images of straight lines.
#pragma once
#include <string>
#include <vector>

#include "calibration/lines/scene_line.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// The shortest edge that is kept, of the picture's diagonal.
inline constexpr double kShortestLine = 0.1;

/// Line segments (LSD: Grompone von Gioi et al. 2012), joined where they go on over a gap or a slight bend with the
/// same side bright, so that both sides of a bar are two lines; then their points, each the place of a blurred step
/// across a short piece (calibration/lines/edge_place.h), about a smooth curve through all of them. Points that lie off
/// the curve (what hides the edge) are left out. In the order of their length.
std::vector<SceneLine> find_lines(const formats::Image& image, int channel, const std::string& name);

}  // namespace lensproof::calibration
