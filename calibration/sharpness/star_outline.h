// calibration/sharpness/star_outline.h — where a star's black sectors end.
#pragma once
#include <opencv2/core.hpp>
#include <optional>

#include "calibration/sharpness/star_map.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// Scales A and sets the perspective from the ends of the black sectors, by least squares without outliers. They are
/// looked for from a circle of the pattern outwards, `pattern_px` its radius; without it, from within the present rim.
/// False where fewer than a third of the ends are seen.
bool fit_rim(const cv::Mat& plane, const scene::SiemensStar& star, std::optional<double> pattern_px, StarMap& map);

}  // namespace lensproof::calibration
