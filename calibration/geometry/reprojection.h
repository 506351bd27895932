// calibration/geometry/reprojection.h — where a feature of a posed chart is imaged, and how that depends on everything.
#pragma once
#include <array>
#include <memory>
#include <optional>

#include "calibration/geometry/board_shape.h"
#include "calibration/geometry/camera_model.h"
#include "calibration/geometry/planar_pose.h"
#include "engine/base/vec.h"

namespace ceres {
class CostFunction;
}

namespace lensproof::calibration {

/// A feature as measured.
struct Feature {
    Vec2d chart_mm{};
    Vec2d image_px{};
    double disc_diameter_mm = 0.0;                  // 0: a point; else the centroid of the disc's image
    std::optional<Vec3d> direction = std::nullopt;  // of what is infinitely far away, in place of a place on the chart
};

using PoseParameters = std::array<double, 6>;  // rotation vector, translation (mm)
using BoardHeights = std::array<double, kBoardTerms>;

PoseParameters pose_parameters(const Pose& pose);
Pose to_pose(const PoseParameters& parameters);

/// Where a view's feature is expected: the image of a point, or the centroid of the image of a disc.
/// `board`: how far the chart is from flat; none: it is flat.
std::optional<Vec2d> predict(const CameraModel& model, const Pose& pose, const Vec2d& chart_mm, double disc_diameter_mm,
                             const std::optional<BoardShape>& board = std::nullopt);

/// Measured minus predicted, px: two residuals of three blocks of parameters, the model's (as many as `kind` has), a
/// pose's (6; a direction turns with it and does not move) and the board's heights (5). Fails where the model images
/// nothing. One type serves every model.
std::unique_ptr<ceres::CostFunction> reprojection_cost(ModelKind kind, const Feature& feature, const BoardFrame& frame);

}  // namespace lensproof::calibration
