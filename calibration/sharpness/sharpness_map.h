// calibration/sharpness/sharpness_map.h — MTF50 over the frame, of whatever lens: also one that is not centred.
#pragma once
#include <vector>

#include "calibration/sharpness/slanted_edge.h"

namespace lensproof::calibration {

/// Values at knots that stand evenly over the frame, from edge to edge, row by row from the top.
struct SharpnessMap {
    int columns = 0;
    int rows = 0;
    std::vector<double> mtf50_cycles_per_px;  // NaN: no edge near
};

/// At each knot the median of the edges around it, weighed by a Gaussian of a twelfth of the frame's diagonal, edges of
/// every direction together: a few that are blurred by themselves do not move it. Knots farther than two of those
/// standard deviations from any edge have no value.
SharpnessMap sharpness_map(const std::vector<EdgeMtf>& edges, int width_px, int height_px);

}  // namespace lensproof::calibration
