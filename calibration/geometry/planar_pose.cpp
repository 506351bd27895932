#include "calibration/geometry/planar_pose.h"

#include <ceres/rotation.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calibration/statistics/dense_solvers.h"

namespace lensproof::calibration {

Vec3d turned(const Pose& pose, const Vec3d& direction) {
    const double rotation[3] = {pose.rotation_rad.x, pose.rotation_rad.y, pose.rotation_rad.z};
    const double from[3] = {direction.x, direction.y, direction.z};
    double rotated[3];
    ceres::AngleAxisRotatePoint(rotation, from, rotated);
    return {rotated[0], rotated[1], rotated[2]};
}

Vec3d to_camera(const Pose& pose, const Vec2d& chart_mm) {
    return turned(pose, {chart_mm.x, chart_mm.y, 0.0}) + pose.translation_mm;
}

std::optional<Pose> planar_pose(const std::vector<Vec2d>& chart_mm, const std::vector<Vec3d>& rays) {
    double scale = 0.0;  // chart coordinates are brought to size 1
    for (const Vec2d& point : chart_mm) {
        scale = std::max({scale, std::abs(point.x), std::abs(point.y)});
    }
    if (chart_mm.size() < 4 || rays.size() != chart_mm.size() || !(scale > 0.0)) {
        return std::nullopt;
    }
    Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Eigen::Vector3d x(chart_mm[i].x / scale, chart_mm[i].y / scale, 1.0);
        Eigen::Matrix3d across;  // across * v = ray × v
        across << 0.0, -rays[i].z, rays[i].y, rays[i].z, 0.0, -rays[i].x, -rays[i].y, rays[i].x, 0.0;
        Eigen::Matrix<double, 3, 9> equations;
        equations << x(0) * across, x(1) * across, x(2) * across;
        normal += equations.transpose() * equations;
    }
    const auto [values, vectors] = symmetric_eigen(normal);
    if (!(values(1) > 1e-12 * values(8))) {
        return std::nullopt;
    }
    Eigen::Matrix<double, 9, 1> h = vectors.col(0);
    double agreement = 0.0;  // H X must point along the ray, not against it
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Eigen::Vector3d seen =
            (chart_mm[i].x / scale) * h.head<3>() + (chart_mm[i].y / scale) * h.segment<3>(3) + h.tail<3>();
        agreement += seen.dot(Eigen::Vector3d(rays[i].x, rays[i].y, rays[i].z)) > 0.0 ? 1.0 : -1.0;
    }
    if (agreement < 0.0) {
        h = -h;
    }
    const Eigen::Vector3d first = h.head<3>();
    const Eigen::Vector3d second = h.segment<3>(3);
    const double size = 0.5 * (first.norm() + second.norm());
    Eigen::Matrix3d columns;
    columns << first, second, first.cross(second) / size;
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(columns, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
    const Eigen::Vector3d translation = scale / size * h.tail<3>();
    double vector[3];
    ceres::RotationMatrixToAngleAxis(rotation.data(), vector);
    const Pose pose{{vector[0], vector[1], vector[2]}, {translation(0), translation(1), translation(2)}};
    const bool finite = std::isfinite(vector[0] + vector[1] + vector[2]) && translation.allFinite();
    return finite && rotation.determinant() > 0.0 ? std::optional(pose) : std::nullopt;
}

}  // namespace lensproof::calibration
