// engine/scene/chart/pose.h — where a chart stands in front of a camera.
#pragma once
#include <array>

#include "engine/base/vec.h"

namespace lensproof::scene {

/// A rigid motion from chart coordinates to camera coordinates: X_camera = R · X_chart + t; mm.
///
/// The camera frame is OpenCV's, with its origin at the vertex of the lens's first surface: x to the right of the
/// picture, y down, z into the scene. In lens space (+z towards the sensor, +y up) that is (x, −y, −z).
struct RigidMotion {
    std::array<Vec3d, 3> rotation_rows{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
    Vec3d translation;
};

/// A chart seen in a direction, facing the camera, then tilted in place.
struct Placement {
    double distance_mm = 0.0;          // from the first vertex to the chart's centre
    double towards_right_deg = 0.0;    // direction of the centre: azimuth from the axis, to the right,
    double towards_down_deg = 0.0;     // and elevation from that, downwards
    std::array<double, 3> tilt_deg{};  // about the chart's own x, y and z, in that order, after it faces the camera
};

RigidMotion place(const Placement& placement);

/// Between the camera frame and lens space; its own inverse.
inline Vec3d camera_to_lens(const Vec3d& v) {
    return {v.x, -v.y, -v.z};
}

/// R · v, and Rᵀ · v.
inline Vec3d rotate(const RigidMotion& motion, const Vec3d& v) {
    const auto& r = motion.rotation_rows;
    return {dot(r[0], v), dot(r[1], v), dot(r[2], v)};
}
inline Vec3d rotate_back(const RigidMotion& motion, const Vec3d& v) {
    const auto& r = motion.rotation_rows;
    return v.x * r[0] + v.y * r[1] + v.z * r[2];
}

/// R · X + t of a point, and back.
inline Vec3d moved(const RigidMotion& motion, const Vec3d& point) {
    return rotate(motion, point) + motion.translation;
}
inline Vec3d moved_back(const RigidMotion& motion, const Vec3d& point) {
    return rotate_back(motion, point - motion.translation);
}

}  // namespace lensproof::scene
