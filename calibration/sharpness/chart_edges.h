// calibration/sharpness/chart_edges.h — where a found chart has edges to measure.
#pragma once
#include <vector>

#include "calibration/detection/refine.h"
#include "calibration/sharpness/slanted_edge.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// The four sides of each square of a slanted-edge chart, and of a checkerboard or ChArUco board every side between two
/// inner corners, as far as the points around it were found. Corners, and what lies beyond a side's two tones (the next
/// square, a marker), stay outside. Regions too small to measure are left out; at most 96 × 48 pixels of an edge are
/// taken. Whether the picture shows a side slanted enough is for `measure_edge` to say. Empty for other charts.
std::vector<EdgeRegion> chart_edges(const ChartPoints& points, const scene::Chart& chart);

}  // namespace lensproof::calibration
