// engine/base/affine.h — affine maps, which place shapes, charts and cameras in a scene.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/base/vec.h"

namespace lensproof {

using Matrix3 = std::array<Vec3d, 3>;  // rows

inline constexpr Matrix3 kIdentity3{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};

/// a · b.
Matrix3 product(const Matrix3& a, const Matrix3& b);
double determinant(const Matrix3& m);

/// Turns about an axis of the frame, counter-clockwise for one who looks against the axis.
Matrix3 about_x(double degrees);
Matrix3 about_y(double degrees);
Matrix3 about_z(double degrees);

inline Vec3d operator*(const Matrix3& m, const Vec3d& v) {
    return {dot(m[0], v), dot(m[1], v), dot(m[2], v)};
}

/// mᵀ · v.
inline Vec3d transposed_times(const Matrix3& m, const Vec3d& v) {
    return v.x * m[0] + v.y * m[1] + v.z * m[2];
}

/// The largest of the coordinates, whatever their signs.
inline double largest_coordinate(const Vec3d& v) {
    return std::max(std::max(std::abs(v.x), std::abs(v.y)), std::abs(v.z));
}

/// X ↦ linear · X + translation; mm.
struct AffineMap {
    Matrix3 linear = kIdentity3;
    Vec3d translation;
};

inline Vec3d map_point(const AffineMap& map, const Vec3d& point) {
    return map.linear * point + map.translation;
}

/// The point that a rigid motion, whose `linear` is a rotation, takes to `point`.
inline Vec3d point_before(const AffineMap& motion, const Vec3d& point) {
    return transposed_times(motion.linear, point - motion.translation);
}

/// What `after` does to the outcome of `first`.
AffineMap composed(const AffineMap& after, const AffineMap& first);

/// Nothing where the map is singular, which is where a volume shrinks below 1e-12 of what its longest row would span.
std::optional<AffineMap> inverse(const AffineMap& map);

/// The factors by which the map stretches along its three principal directions (singular values), the largest first.
Vec3d principal_stretches(const Matrix3& linear);

}  // namespace lensproof
