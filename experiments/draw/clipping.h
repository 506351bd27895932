// experiments/draw/clipping.h — the part of lines and areas that lies inside a frame.
#pragma once
#include <vector>

#include "experiments/draw/chart.h"

namespace lensproof::draw {

/// The pieces of a polyline inside the box; a point that is not finite breaks it. Single points between two breaks
/// remain as pieces of one point.
std::vector<std::vector<SvgPoint>> clipped_line(const std::vector<SvgPoint>& points, const PageBox& box);

/// The part of a polygon inside the box (Sutherland & Hodgman 1974); points that are not finite are left out.
std::vector<SvgPoint> clipped_polygon(const std::vector<SvgPoint>& points, const PageBox& box);

/// The lines at 45° (y falls as x rises) inside closed outlines, two points each: x + y is `start` and whole steps from
/// there. An outline in another is a hole, whichever sense they have. Outlines are clipped before, since the lines are
/// as many as steps fit into them.
std::vector<std::vector<SvgPoint>> hatching(const std::vector<std::vector<SvgPoint>>& outlines, double step,
                                            double start = 0.0);

bool is_inside(const PageBox& box, SvgPoint point);

}  // namespace lensproof::draw
