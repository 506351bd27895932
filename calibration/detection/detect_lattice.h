// calibration/detection/detect_lattice.h — finds charts of discs, dots, squares or crossing lines.
#pragma once
#include <opencv2/core.hpp>

#include "calibration/detection/chart_search.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// A chart's points in a CV_8U picture, from the largest lattice of its spots there
/// (calibration/detection/blob_lattice.h); of crossing lines the spots are the white cells between them. A quarter of
/// the points, and nine of them, have to be seen. Where fewer columns or rows are seen than the chart has, which they
/// are cannot be told: they are taken for the chart's middle ones, and a pose fitted to them is off by whole pitches.
ChartSearch find_lattice(const cv::Mat& picture, scene::GridSize grid, const scene::Spots& spots);
ChartSearch find_lattice(const cv::Mat& picture, scene::GridSize grid, const scene::LineCrossings& lines);

}  // namespace lensproof::calibration
