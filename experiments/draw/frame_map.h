// experiments/draw/frame_map.h — a quantity over a camera's frame, and beside it the points that it was found from.
#pragma once
#include <string>
#include <vector>

#include "engine/base/vec.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/ticks.h"

namespace lensproof::draw {

/// Values at knots that stand evenly over the frame, from edge to edge, row by row from the top. Pixels as in
/// engine/formats/image/image.h, y down.
struct FrameMap {
    std::string title{};
    std::string heading{};  // over the colours
    std::string label{};    // of the colours
    std::string unit{};
    int width_px = 0;
    int height_px = 0;
    int columns = 0;  // of knots, at least 2, as of rows
    int rows = 0;
    std::vector<double> values{};  // NaN: none there
    std::vector<bool> covered{};   // whether the knot lies in the points' hull
    std::vector<Vec2d> points{};
    std::vector<Vec2d> hull{};  // convex
};

/// The maps' values from the smallest inside the points' hulls to the largest, ten times that inside the hulls at most:
/// one range for all drawings, so that colours compare. 0.001 to 1 where there is no value.
AxisRange common_range(const std::vector<const FrameMap*>& maps);

/// A chart with the frame as its axes and nothing in it.
PlotChart frame_chart(const FrameMap& map, const std::string& title);

/// The values between the knots, and none where one of the knots around has none.
HeatMap frame_heat_map(const FrameMap& knots, const AxisRange& range, AxisScale scale);

/// As SVG: left the values as colours, logarithmic over `range`, right the points in `colour` (CSS); in both the hull
/// as an outline, and what lies outside it, where the values are extrapolated, hatched.
std::string frame_map_svg(const FrameMap& map, const AxisRange& range, const std::string& colour);

}  // namespace lensproof::draw
