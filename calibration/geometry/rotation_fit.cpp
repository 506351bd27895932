#include "calibration/geometry/rotation_fit.h"

#include <Eigen/Dense>

namespace lensproof::calibration {

Eigen::Matrix3d rotation_onto(std::span<const Vec3d> from, std::span<const Vec3d> to) {
    Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) {
        correlation += Eigen::Vector3d(to[i].x, to[i].y, to[i].z) * Eigen::RowVector3d(from[i].x, from[i].y, from[i].z);
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Vector3d signs(1.0, 1.0, (svd.matrixU() * svd.matrixV().transpose()).determinant());
    return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace lensproof::calibration
