// engine/scene/geometry/packet/analytic_meeting.h — spheres and quads met by a ray, or by several in step.
#pragma once
#include <cmath>
#include <cstdint>

#include "engine/base/affine.h"
#include "engine/base/select.h"

namespace lensproof::scene {

/// A ray in some frame and the open stretch of it that is asked for, in units of `direction`'s length, which an affine
/// map changes while the parameter stays. T: double, or a pack of them.
template <class T>
struct Stretch {
    Vec3<T> origin;
    Vec3<T> direction;
    T from{};
    T to{};
};

template <class T>
Stretch<T> mapped(const AffineMap& map, const Stretch<T>& ray) {
    const auto turned = [&](const Vec3<T>& v) {
        const auto along = [&](const Vec3d& row) { return T(row.x) * v.x + T(row.y) * v.y + T(row.z) * v.z; };
        return Vec3<T>{along(map.linear[0]), along(map.linear[1]), along(map.linear[2])};
    };
    const Vec3<T> moved{T(map.translation.x), T(map.translation.y), T(map.translation.z)};
    return {.origin = turned(ray.origin) + moved, .direction = turned(ray.direction), .from = ray.from, .to = ray.to};
}

/// Where along the ray, and where on the surface: a triangle's barycentric coordinates of its second and third vertex,
/// a quad's x and y; nothing of use for a sphere.
template <class T>
struct Meeting {
    T at{};
    T b1{};
    T b2{};
};

/// A meeting, where there is one.
template <class T>
struct Crossing {
    MaskOf<T> is_met{};
    Meeting<T> meeting;
};

/// The first meeting on the stretch with a shape that `to_local` carries into its own frame. The sphere's roots are
/// taken about the ray's nearest point to the centre, so that nothing cancels for a small sphere far away (Haines et
/// al., Ray Tracing Gems, ch. 7).
template <class T>
Crossing<T> meet_sphere(double radius_mm, const AffineMap& to_local, const Stretch<T>& world_ray) {
    using std::sqrt;
    const T zero(0.0);
    const T radius(radius_mm);
    const Stretch<T> ray = mapped(to_local, world_ray);
    const T squared = dot(ray.direction, ray.direction);
    const T nearest = -dot(ray.origin, ray.direction) / squared;
    const Vec3<T> p = ray.origin + nearest * ray.direction;
    const T left = radius * radius - dot(p, p);
    const MaskOf<T> is_near = left >= zero;
    if (!any(is_near)) {
        return {};
    }
    const T half_chord = sqrt(select(is_near, left, zero) / squared);
    // The root that is nearer to the origin by Vieta's product of both: their difference would cancel on the sphere.
    const T far = nearest + select(nearest < zero, -half_chord, half_chord);
    const T distance = length(ray.origin);
    const T product = (distance - radius) * (distance + radius) / squared;
    const MaskOf<T> is_through = far < zero || far > zero;
    const T near = select(is_through, product / select(is_through, far, T(1.0)), zero);
    const MaskOf<T> is_ordered = near < far;
    const T first = select(is_ordered, near, far);
    const T second = select(is_ordered, far, near);
    const MaskOf<T> is_first = first > ray.from && first < ray.to;
    return {.is_met = is_near && (is_first || (second > ray.from && second < ray.to)),
            .meeting = {.at = select(is_first, first, second)}};
}

template <class T>
Crossing<T> meet_quad(const Vec2d& half_mm, const AffineMap& to_local, const Stretch<T>& ray) {
    using std::abs;
    const auto along = [&](const Vec3d& row, const Vec3<T>& v) {
        return T(row.x) * v.x + T(row.y) * v.y + T(row.z) * v.z;
    };
    // Of most rays the height above the plane alone says that they miss.
    const T height = along(to_local.linear[2], ray.origin) + T(to_local.translation.z);
    const T at = -height / along(to_local.linear[2], ray.direction);
    const MaskOf<T> is_ahead = at > ray.from && at < ray.to;
    if (!any(is_ahead)) {
        return {};
    }
    const Vec3<T> point = ray.origin + at * ray.direction;
    const T x = along(to_local.linear[0], point) + T(to_local.translation.x);
    const T y = along(to_local.linear[1], point) + T(to_local.translation.y);
    return {.is_met = is_ahead && abs(x) <= T(half_mm.x) && abs(y) <= T(half_mm.y),
            .meeting = {.at = at, .b1 = x, .b2 = y}};
}

/// A sphere or quad where it stands.
struct AnalyticObject {
    AffineMap to_local;
    double radius_mm = 0.0;  // 0: it is a quad
    Vec2d half_mm;           // of the quad's width and height
    std::uint32_t object = 0;
};

template <class T>
Crossing<T> meet(const AnalyticObject& object, const Stretch<T>& ray) {
    return object.radius_mm > 0.0 ? meet_sphere(object.radius_mm, object.to_local, ray)
                                  : meet_quad(object.half_mm, object.to_local, ray);
}

}  // namespace lensproof::scene
