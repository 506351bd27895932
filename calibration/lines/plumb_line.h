// calibration/lines/plumb_line.h — how straight a line is under a lens: the plumb-line method's one residual.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

#include "engine/base/vec.h"

namespace lensproof::calibration {

/// What points of a picture undo to. Places are counted from the optical centre in units of half the diagonal, r being
/// their distance from it and t = r²:
///
///     perspective:  a place q = p (1 + k1 t + k2 t² + k3 t³) of the undistorted picture, in which straight lines are
///                   straight (Brown 1971, "Close-range camera calibration": corrections over the distorted radius);
///     fisheye:      the direction at the angle θ = φ r (1 + b1 t + b2 t²) from the axis; a straight line and the
///                   camera lie in a plane (with φ alone Devernay & Faugeras 2001's "FOV" model). It is a shape for
///                   wide lenses, no angle: lines are as straight where every tan θ grows by one factor.
enum class PlumbKind { perspective, fisheye };

inline constexpr std::size_t kShapeTerms = 3;  // k1, k2, k3 or φ, b1, b2
inline constexpr std::size_t kPlumbTerms = 5;  // and the centre, from the picture's middle

/// Where the optical centre is believed to lie: a standard error of 2 % of half the diagonal about the picture's
/// middle in x and in y, which counts as one more observation.
inline constexpr double kCentrePrior = 0.02;

/// The point's direction is (s x, s y, z) of any length; slopes are with t.
template <class T>
struct PlumbRay {
    T s;
    T z;
    T s_slope;
    T z_slope;
};

template <class T>
PlumbRay<T> plumb_ray(PlumbKind kind, const T* shape, const T& t) {
    using std::cos;
    using std::sin;
    using std::sqrt;
    if (kind == PlumbKind::perspective) {
        return {T(1) + t * (shape[0] + t * (shape[1] + t * shape[2])), T(1),
                shape[0] + t * (T(2) * shape[1] + T(3) * t * shape[2]), T(0)};
    }
    const T m = T(1) + t * (shape[1] + t * shape[2]);
    const T m_slope = shape[1] + T(2) * t * shape[2];
    if (t < T(1e-10)) {  // sin θ / r and cos θ to second order
        const T f2 = shape[0] * shape[0];
        return {shape[0], T(1), shape[0] * (shape[1] - f2 / T(6)), T(-0.5) * f2};
    }
    const T r = sqrt(t);
    const T angle = shape[0] * r * m;
    const T r_angle_slope = shape[0] * (T(0.5) * m + t * m_slope);  // r dθ/dt
    const T s = sin(angle) / r;
    return {s, cos(angle), (cos(angle) * r_angle_slope - T(0.5) * s) / t, -s * r_angle_slope};
}

/// How far the place `p` (from the picture's middle, in half diagonals) lies from the image of the plane with that
/// normal, along the image's own normal: to first order the distance in the picture, so that a lens that shrinks the
/// undistorted picture gains nothing by it.
template <class T>
T plumb_residual(PlumbKind kind, const T* shape, const T* centre, const T* normal, const Vec2d& p) {
    using std::sqrt;
    const T x = T(p.x) - centre[0];
    const T y = T(p.y) - centre[1];
    const PlumbRay<T> ray = plumb_ray(kind, shape, T(x * x + y * y));
    const T flat = normal[0] * x + normal[1] * y;
    const T slope = T(2) * (ray.s_slope * flat + ray.z_slope * normal[2]);
    const T gx = ray.s * normal[0] + slope * x;
    const T gy = ray.s * normal[1] + slope * y;
    return (ray.s * flat + ray.z * normal[2]) / sqrt(gx * gx + gy * gy + T(1e-30));
}

}  // namespace lensproof::calibration
