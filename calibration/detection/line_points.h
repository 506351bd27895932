// calibration/detection/line_points.h — points along a chart's straight lines, between their crossings.
#pragma once
#include <vector>

#include "calibration/detection/refine.h"
#include "engine/base/vec.h"
#include "engine/formats/image/image.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration {

struct LinePoint {
    Vec2d image_px;
    double standard_error_px = 0.0;  // across the line; along it the point is where it was looked for
};

/// The points of one line, in order.
struct LinePoints {
    bool is_column = false;
    int index = 0;
    std::vector<LinePoint> points;
};

/// Between each two neighbouring crossings that were found, three pieces of the line away from both: in each the
/// centroid across the line of the light that is missing from the paper's, in linear light, of all pixels of the piece
/// (a straight line through both sides' paper is the ground). Pieces without contrast or with clipped or missing pixels
/// are left out. Empty for other charts than straight lines.
std::vector<LinePoints> line_points(const formats::Image& image, int channel, const ChartPoints& points,
                                    const scene::Chart& chart);

}  // namespace lensproof::calibration
