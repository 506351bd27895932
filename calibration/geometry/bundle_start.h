// calibration/geometry/bundle_start.h — where a bundle adjustment may begin when nothing is known.
#pragma once
#include <optional>
#include <vector>

#include "calibration/geometry/bundle.h"

namespace lensproof::calibration {

struct BundleStart {
    double misfit_px = 0.0;  // rms distance between the points seen and those of the posed chart
    BundleState state;
};

/// Undistorted cameras of focal lengths from a 180° fisheye's to a long lens's (or of the one that is known), centred,
/// with the chart posed by `planar_pose`, directions by `rotation_onto`; the best first. Throws InputError when no view
/// can be posed in any.
std::vector<BundleStart> bundle_starts(const PointBundle& bundle, ModelKind model, int width, int height,
                                       std::optional<double> known_focal_px);

}  // namespace lensproof::calibration
