// calibration/lines/line_chains.h — line segments that go on in each other.
#pragma once
#include <vector>

#include "calibration/detection/line_segments.h"

namespace lensproof::calibration {

/// Directed pieces of an edge, the same side of all being the bright one.
using LineChain = std::vector<LineSegment>;
double chord_of(const LineChain& chain);

/// Each segment goes on in the nearest that lies on a common circle with it within about a pixel of the search
/// (`scale`), turns by less than 9°, and is no farther than both are long. From the longest on; each belongs to one
/// chain.
std::vector<LineChain> joined_segments(std::vector<LineSegment> segments, double scale);

}  // namespace lensproof::calibration
