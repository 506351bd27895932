// calibration/detection/chart_search.h — what a search for a chart in OpenCV's copy of a picture comes back with.
#pragma once
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "calibration/detection/numbering.h"

namespace lensproof::calibration {

/// The chart's points by number, to a pixel or two; or why there are none.
struct ChartSearch {
    std::vector<cv::Point2f> points;
    std::vector<bool> found;  // which of them the picture shows
    std::string reason;       // empty where the chart was found
    Numbering numbering = Numbering::certain;
};

}  // namespace lensproof::calibration
