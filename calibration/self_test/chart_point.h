// calibration/self_test/chart_point.h — where a camera's pixels look on a chart.
#pragma once
#include <optional>

#include "calibration/geometry/board_shape.h"
#include "calibration/geometry/camera_model.h"
#include "calibration/geometry/planar_pose.h"

namespace lensproof::calibration {

/// Where `direction` (camera frame) meets a chart at `pose`, in front of the camera, mm. One that is not flat has the
/// heights of `board` over its plane; beyond its frame it goes straight on.
std::optional<Vec2d> chart_point(const Vec3d& direction, const Pose& pose, const std::optional<BoardShape>& board);

/// The same for the direction that `pixel` shows.
std::optional<Vec2d> chart_point(const CameraModel& model, const Pose& pose, const Vec2d& pixel,
                                 const std::optional<BoardShape>& board = std::nullopt);

}  // namespace lensproof::calibration
