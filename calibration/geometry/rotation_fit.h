// calibration/geometry/rotation_fit.h — the rotation between two sets of directions.
#pragma once
#include <Eigen/Core>
#include <span>

#include "engine/base/vec.h"

namespace lensproof::calibration {

/// The rotation that brings the directions `from` closest to `to`, each to its own, in least squares (Kabsch 1976, Acta
/// Crystallographica A32, 922). Any of those that do where there are fewer than two directions.
Eigen::Matrix3d rotation_onto(std::span<const Vec3d> from, std::span<const Vec3d> to);

}  // namespace lensproof::calibration
