// engine/scene/chart/pose.h — where a chart stands in front of a camera.
#pragma once
#include <array>

#include "engine/base/affine.h"

namespace lensproof::scene {

/// A chart seen in a direction, facing the camera, then tilted in place.
struct Placement {
    double distance_mm = 0.0;          // from the first vertex to the chart's centre
    double towards_right_deg = 0.0;    // direction of the centre: azimuth from the axis, to the right,
    double towards_down_deg = 0.0;     // and elevation from that, downwards
    std::array<double, 3> tilt_deg{};  // about the chart's own x, y and z, in that order, after it faces the camera
};

/// The rigid motion from chart coordinates to the camera's.
///
/// The camera frame is OpenCV's, with its origin at the vertex of the lens's first surface: x to the right of the
/// picture, y down, z into the scene. In lens space (+z towards the sensor, +y up) that is (x, −y, −z).
AffineMap place(const Placement& placement);

/// Between the camera frame and lens space; its own inverse.
inline Vec3d camera_to_lens(const Vec3d& v) {
    return {v.x, -v.y, -v.z};
}

}  // namespace lensproof::scene
