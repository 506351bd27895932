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

bool is_inside(const PageBox& box, SvgPoint point);

}  // namespace lensproof::draw
