// engine/optics/intersect.h — where a ray meets a spherical or flat surface.
#pragma once
#include <cmath>

#include "engine/base/ray.h"
#include "engine/base/select.h"

namespace lensproof::optics {

/// The outcome of `intersect`. Where `hit` is false the numbers are meaningless.
template <class T>
struct Intersection {
    Vec3<T> point;     // relative to the surface's vertex, mm
    T distance;        // along the ray, signed, mm
    T cos_incidence;   // positive; between the ray and the surface's normal
    T sin2_incidence;  // the square of that angle's sine
    decltype(T() < T()) hit;
};

/// Where the ray from `origin` along `direction` crosses a sphere of curvature `c` (1/mm), whose vertex is (0, 0, 0),
/// from the side of negative z to that of positive z (`heading` = +1, light towards the sensor) or back (`heading` =
/// −1). For an origin that is near the vertex in units of the radius, |c| |o| ≤ 2 or so: each unit of its square costs
/// an ulp. `intersect` is for any origin.
///
/// Solved in curvature form, so that flat (c = 0) and nearly flat surfaces lose no digits:
///     c s² − 2 b s + f = 0,   b = d_z − c o·d,   f = c o·o − 2 o_z,   cos² i = b² − c f
/// (Feder 1951; Welford, Aberrations of Optical Systems, ch. 4). Of the two roots the one is taken at which d·n has the
/// heading's sign, each in the form that does not cancel: f / q or q / c with q = b ± cos i of equal signs. So a ray
/// that enters a fisheye from 90° off the axis or more (d_z ≤ 0, heading +1) finds the front of the sphere too. Only
/// the half of the sphere that carries the vertex counts (1 − c z > 0).
///
/// sin² i = 1 − b² + c f is formed from 1 − d_z² = d_x² + d_y². From the cosine it would be known to an ulp of 1 only,
/// which at a critical angle weighs μ² times as much; and it need not wait for the root.
///
/// T: float, double, long double, a multiprecision number, ceres::Jet or a packet. A ray that misses, or only
/// touches, has `hit` false and meaningless numbers elsewhere.
template <class T>
constexpr Intersection<T> intersect_from_near(const Vec3<T>& origin, const Vec3<T>& direction, const T& c,
                                              const T& heading) {
    using std::sqrt;
    const T c_along = c * dot(origin, direction);
    const T b = direction.z - c_along;
    const T f = c * dot(origin, origin) - T(2) * origin.z;
    const T discriminant = b * b - c * f;
    const auto meets_sphere = discriminant > T(0);
    const T cos_incidence = sqrt(select(meets_sphere, discriminant, T(1)));
    const auto along = b * heading > T(0);
    auto meets = meets_sphere;
    T s;
    if (all(along)) {  // but for light from beyond 90°
        s = f / (b + heading * cos_incidence);
    } else {
        const auto curved = c < T(0) || c > T(0);
        const T q = b + select(along, heading, -heading) * cos_incidence;
        s = select(along, f, q) / select(along, q, select(curved, c, T(1)));
        meets = meets && (along || curved);
    }
    const T z = origin.z + s * direction.z;
    const T across = direction.x * direction.x + direction.y * direction.y;
    return {.point = {origin.x + s * direction.x, origin.y + s * direction.y, z},
            .distance = s,
            .cos_incidence = cos_incidence,
            .sin2_incidence = across + (c * f + c_along * (direction.z + b)),
            .hit = meets && T(1) - c * z > T(0)};
}

/// The same of the plane c = 0, to the bit where it is hit: a root less, since the root of a rounded square is what was
/// squared.
template <class T>
constexpr Intersection<T> intersect_plane_from_near(const Vec3<T>& origin, const Vec3<T>& direction, const T& heading) {
    const T s = (T(0) - T(2) * origin.z) / (direction.z + direction.z);
    return {.point = {origin.x + s * direction.x, origin.y + s * direction.y, origin.z + s * direction.z},
            .distance = s,
            .cos_incidence = direction.z * heading,
            .sin2_incidence = direction.x * direction.x + direction.y * direction.y,
            .hit = direction.z * heading > T(0) && direction.z * direction.z > T(0)};
}

/// Along the ray to its closest approach to the vertex (0, 0, 0), mm.
template <class T>
constexpr T distance_to_vertex(const Vec3<T>& origin, const Vec3<T>& direction) {
    return -dot(origin, direction);
}

/// The same from any origin o, from the ray's closest approach to the vertex, p = o − (o·d) d: far-away origins do
/// not matter. p·d would be zero but for rounding: from an object at 1e12 mm it is 1e-4 mm, and b carries it.
template <class T>
constexpr Intersection<T> intersect(const Vec3<T>& origin, const Vec3<T>& direction, const T& c, const T& heading) {
    const T to_vertex = distance_to_vertex(origin, direction);
    Intersection<T> meeting = intersect_from_near(origin + to_vertex * direction, direction, c, heading);
    meeting.distance = to_vertex + meeting.distance;
    return meeting;
}

template <class T>
constexpr Intersection<T> intersect(const Ray<T>& ray, const T& c, const T& heading) {
    return intersect(ray.origin, ray.direction, c, heading);
}

}  // namespace lensproof::optics
