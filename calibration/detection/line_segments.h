// calibration/detection/line_segments.h — straight pieces of a picture's edges.
#pragma once
#include <vector>

#include "engine/base/vec.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// A piece of an edge, px.
struct LineSegment {
    Vec2d from;
    Vec2d to;
};
double length_of(const LineSegment& segment);
/// From its start to its end, of length 1.
Vec2d direction_of(const LineSegment& segment);

struct FoundSegments {
    std::vector<LineSegment> segments;  // in pixels of the whole picture, none of no length
    double scale = 1.0;                 // pixels of the picture per pixel that was searched
};

/// By brightness, all channels together (von Gioi, Jakubowicz, Morel & Randall 2012, through OpenCV); of larger
/// pictures than 2400 px a side in a smaller copy.
FoundSegments find_segments(const formats::Image& image);

}  // namespace lensproof::calibration
