// calibration/detect.h — finds a chart in a picture, to about a pixel.
#pragma once
#include <string>

#include "calibration/refine.h"
#include "engine/io/image.h"
#include "engine/scene/chart.h"

namespace lensproof {

/// Whether `detect` knows charts of this kind: checkerboards and disc grids.
bool can_detect(const Chart& chart);

/// What a picture shows of a chart.
struct Detection {
    ChartPoints points;  // to about a pixel; none where the chart was not found
    std::string reason;  // why it was not found, in words ("the picture is too dark"); empty where it was

    [[nodiscard]] bool found() const { return reason.empty(); }
};

/// Looks for `feature_points(chart)`; `points.found` says which of them the picture shows.
///
/// OpenCV's detectors search an 8-bit working copy; where the lens bends the chart too much for them, copies that
/// undo a guessed fisheye projection are searched too. Accurate to a pixel or so: `refine` gives the final positions.
///
/// Which corner is the first: the one whose square is black, as the chart says. Where that leaves a choice (a half
/// turn of a board with an even number of columns + rows, every disc grid) the rows run to the right as far as
/// possible. Mirror images are never taken. A checkerboard needs at least 3 × 3 inner corners, a disc grid 3 × 3 discs.
/// Throws InputError for a chart that cannot be detected, or has too few points.
Detection detect(const Image& image, const Chart& chart);

}  // namespace lensproof
