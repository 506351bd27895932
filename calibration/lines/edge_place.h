// calibration/lines/edge_place.h — where light changes from dark to bright across an edge, to a fraction of a pixel.
#pragma once
#include <opencv2/core.hpp>
#include <optional>

#include "engine/base/vec.h"

namespace lensproof::calibration {

/// A short piece of an edge: light is averaged along it.
struct EdgePiece {
    Vec2d centre_px;
    Vec2d along;  // of length 1; a quarter turn from it, (along.y, -along.x), is the bright side
    double half_length_px = 1.5;
    double reach_px = 6.0;  // how far across the edge is looked for
};

struct EdgePlace {
    double across_px = 0.0;  // from the piece's centre towards the bright side
    double standard_error_px = 0.0;
    double contrast = 0.0;  // (bright − dark) / (bright + dark)
};

/// Least squares of a step blurred by a Gaussian, a + b Φ((d − x) / s), over what lies between the neighbouring edges.
/// None where no such step is there: too little contrast, another shape, or the wrong side bright.
std::optional<EdgePlace> edge_place(const cv::Mat& plane, const EdgePiece& piece);

}  // namespace lensproof::calibration
