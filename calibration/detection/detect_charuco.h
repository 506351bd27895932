// calibration/detection/detect_charuco.h — finds the inner corners of a ChArUco board by its markers.
#pragma once
#include <opencv2/core.hpp>

#include "calibration/detection/chart_search.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

/// `picture` is CV_8U. Markers are OpenCV's find, from the board's own markers. A corner lies where the markers nearest
/// to it put it, by a homography of their own (so the lens may bend the board), and counts as found when a marker that
/// it touches is seen and it lies in the picture. Good to a pixel or two. Where markers are missing, a copy is searched
/// too in which some blur is undone.
///
/// OpenCV's `interpolateCornersCharuco` is not used: in version 4.6 its corners come back about 0.53 px off, and its
/// boards are laid out otherwise than those of 4.7 and later.
ChartSearch find_charuco(const cv::Mat& picture, const scene::CharucoBoard& board);

}  // namespace lensproof::calibration
