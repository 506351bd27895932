// calibration/lines/trace_line.h — the points of an edge along a chain of segments.
#pragma once
#include <opencv2/core.hpp>
#include <optional>

#include "calibration/lines/line_chains.h"
#include "calibration/lines/scene_line.h"

namespace lensproof::calibration {

/// Looks for the edge every few pixels along the chain, over its gaps too, fits a polynomial across the chord, and
/// looks again along that, its points without outliers being the line's. None where fewer than a third of the places
/// show the edge, or too few. `scale`: to how many pixels the chain is known.
std::optional<SceneLine> trace_line(const cv::Mat& plane, const LineChain& chain, double scale);

}  // namespace lensproof::calibration
