// calibration/sharpness/star_phase.h — a star's map from the phase of its pattern.
#pragma once
#include <opencv2/core.hpp>

#include "calibration/sharpness/star_map.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// The part of the rim's radius that is measured: the rim itself is an edge.
inline constexpr double kWithinRim = 0.96;

/// Moves the bend until the pattern's phase agrees, in cells of the picture: from the rim, where a sector is many
/// pixels wide and cannot be mistaken for the next, inwards to half a cycle per pixel.
void fit_phase(const cv::Mat& plane, const scene::SiemensStar& star, StarMap& map);

}  // namespace lensproof::calibration
