#include "engine/base/affine.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"

namespace lensproof {

Matrix3 product(const Matrix3& a, const Matrix3& b) {
    Matrix3 result;
    for (std::size_t i = 0; i < 3; ++i) {
        result[i] = transposed_times(b, a[i]);
    }
    return result;
}

double determinant(const Matrix3& m) {
    return dot(m[0], cross(m[1], m[2]));
}

Matrix3 about_x(double degrees) {
    const double c = std::cos(radians(degrees));
    const double s = std::sin(radians(degrees));
    return {Vec3d{1, 0, 0}, Vec3d{0, c, -s}, Vec3d{0, s, c}};
}

Matrix3 about_y(double degrees) {
    const double c = std::cos(radians(degrees));
    const double s = std::sin(radians(degrees));
    return {Vec3d{c, 0, s}, Vec3d{0, 1, 0}, Vec3d{-s, 0, c}};
}

Matrix3 about_z(double degrees) {
    const double c = std::cos(radians(degrees));
    const double s = std::sin(radians(degrees));
    return {Vec3d{c, -s, 0}, Vec3d{s, c, 0}, Vec3d{0, 0, 1}};
}

AffineMap composed(const AffineMap& after, const AffineMap& first) {
    return {.linear = product(after.linear, first.linear), .translation = map_point(after, first.translation)};
}

std::optional<AffineMap> inverse(const AffineMap& map) {
    const Matrix3& m = map.linear;
    const double volume = determinant(m);
    const double longest = std::max({length(m[0]), length(m[1]), length(m[2])});
    constexpr double kSmallestVolume = 1e-12;
    if (!std::isfinite(volume) || !(std::abs(volume) > kSmallestVolume * longest * longest * longest)) {
        return std::nullopt;
    }
    // The adjugate's columns are the cross products of the rows.
    const double scale = 1.0 / volume;
    const Vec3d a = scale * cross(m[1], m[2]);
    const Vec3d b = scale * cross(m[2], m[0]);
    const Vec3d c = scale * cross(m[0], m[1]);
    AffineMap back{.linear = {Vec3d{a.x, b.x, c.x}, Vec3d{a.y, b.y, c.y}, Vec3d{a.z, b.z, c.z}}};
    back.translation = -1.0 * (back.linear * map.translation);
    return back;
}

Vec3d principal_stretches(const Matrix3& linear) {
    Eigen::Matrix3d m;
    for (int i = 0; i < 3; ++i) {
        const Vec3d& row = linear[static_cast<std::size_t>(i)];
        m.row(i) << row.x, row.y, row.z;
    }
    const Eigen::Vector3d values = m.jacobiSvd().singularValues();
    return {values[0], values[1], values[2]};
}

}  // namespace lensproof
