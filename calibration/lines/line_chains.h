// calibration/lines/line_chains.h — line segments that go on in each other.
#pragma once
#include <vector>

#include "engine/base/vec.h"

namespace lensproof::calibration {

/// A directed piece of an edge, px; the same side of all pieces is the bright one.
struct LineSegment {
    Vec2d from;
    Vec2d to;
};
double length_of(const LineSegment& segment);
Vec2d direction_of(const LineSegment& segment);

using LineChain = std::vector<LineSegment>;
double chord_of(const LineChain& chain);

/// Each segment goes on in the nearest that lies on a common circle with it within about a pixel of the search
/// (`scale`), turns by less than 9°, and is no farther than both are long. From the longest on; each belongs to one
/// chain.
std::vector<LineChain> joined_segments(std::vector<LineSegment> segments, double scale);

}  // namespace lensproof::calibration
