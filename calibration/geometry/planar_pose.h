// calibration/geometry/planar_pose.h — where a flat chart stands, seen along known directions.
#pragma once
#include <optional>
#include <vector>

#include "engine/base/vec.h"

namespace lensproof::calibration {

/// Maps chart to camera: X_c = R(rotation) X + t, with X = (x, y, 0) mm on the chart.
struct Pose {
    Vec3d rotation_rad;  // rotation vector (axis times angle)
    Vec3d translation_mm;
};

Vec3d to_camera(const Pose& pose, const Vec2d& chart_mm);

/// A direction by the pose's rotation alone.
Vec3d turned(const Pose& pose, const Vec3d& direction);

/// The pose that explains the unit directions `rays` (camera frame) to the points `chart_mm` of a flat chart.
///
/// A linear solution: ray × (H X) = 0 for H = [r1 r2 t], least singular vector, then the nearest rotation (Zhang 2000,
/// with rays instead of image points, so field angles beyond 90° do no harm). A starting value for a fit, not an
/// estimate. None for fewer than four points or degenerate ones (all on a line).
std::optional<Pose> planar_pose(const std::vector<Vec2d>& chart_mm, const std::vector<Vec3d>& rays);

}  // namespace lensproof::calibration
