#include "engine/scene/pose.h"

#include <cmath>
#include <numbers>

namespace lensproof {

namespace {

using Matrix = std::array<Vec3d, 3>;  // rows

Matrix product(const Matrix& a, const Matrix& b) {
    Matrix result;
    for (std::size_t i = 0; i < 3; ++i) {
        result[i] = a[i].x * b[0] + a[i].y * b[1] + a[i].z * b[2];
    }
    return result;
}

double radians(double degrees) {
    return degrees * std::numbers::pi / 180.0;
}

Matrix about_x(double degrees) {
    const double c = std::cos(radians(degrees));
    const double s = std::sin(radians(degrees));
    return {Vec3d{1, 0, 0}, Vec3d{0, c, -s}, Vec3d{0, s, c}};
}

Matrix about_y(double degrees) {
    const double c = std::cos(radians(degrees));
    const double s = std::sin(radians(degrees));
    return {Vec3d{c, 0, s}, Vec3d{0, 1, 0}, Vec3d{-s, 0, c}};
}

Matrix about_z(double degrees) {
    const double c = std::cos(radians(degrees));
    const double s = std::sin(radians(degrees));
    return {Vec3d{c, -s, 0}, Vec3d{s, c, 0}, Vec3d{0, 0, 1}};
}

}  // namespace

RigidMotion place(const Placement& placement) {
    // Turning about y by a positive angle carries the z axis to the right; about x by a negative one, downwards.
    const Matrix facing = product(about_y(placement.towards_right_deg), about_x(-placement.towards_down_deg));
    const Matrix tilt = product(about_z(placement.tilt_deg[2]),
                                product(about_y(placement.tilt_deg[1]), about_x(placement.tilt_deg[0])));
    const Vec3d direction{facing[0].z, facing[1].z, facing[2].z};
    return {.rotation_rows = product(facing, tilt), .translation = placement.distance_mm * direction};
}

}  // namespace lensproof
