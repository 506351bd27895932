// engine/scene/geometry/packet/analytic_meeting.h — spheres and quads met by a ray, or by several in step.
#pragma once
#include <array>
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

/// Triangles side by side, each by the affine functions of a point in the world that are its height over the plane, mm,
/// and its barycentric coordinates of the second and third vertex (Baldwin and Weber, "Fast ray-triangle intersections
/// by coordinate transformation", JCGT 5, 2016). A lane of zeros is met by nothing.
struct alignas(64) TriangleBlock {
    static constexpr std::size_t kLanes = 8;
    using Column = std::array<double, kLanes>;
    struct Function {
        Column x, y, z, at_origin;
    };
    Function height;
    Function b1;
    Function b2;
    Column b1_slope, b2_slope;  // lengths of the gradients, per mm
};

/// A function of a block at kLanes of its triangles, from `lane` on.
template <class T>
struct LaneFunction {
    Vec3<T> gradient;
    T at_origin;

    [[nodiscard]] T along(const Vec3<T>& direction) const { return dot(gradient, direction); }
    [[nodiscard]] T at(const Vec3<T>& point) const { return dot(gradient, point) + at_origin; }
};

/// Triangles grown by more than rounding does to the coordinates of a meeting, 16 roundings of `reach_mm`, which is
/// that of the ray's origin and theirs: a ray at the edge of two, or at a vertex of many, so meets one of them. (Of a
/// million aimed to the last bit hundreds are lost with half a rounding, none with four.) `ray_origin` moves rays
/// farther off the surface that they leave than its neighbours are grown.
template <class T>
Crossing<T> meet_triangles(const LaneFunction<T>& height, const LaneFunction<T>& first, const LaneFunction<T>& second,
                           const T& first_slope, const T& second_slope, double reach_mm, const Stretch<T>& ray) {
    const T at = -height.at(ray.origin) / height.along(ray.direction);
    const Vec3<T> point = ray.origin + at * ray.direction;
    const T b1 = first.at(point);
    const T b2 = second.at(point);
    const T seam(16.0 * 0x1p-53 * reach_mm);
    const T seam1 = seam * first_slope;
    const T seam2 = seam * second_slope;
    return {
        .is_met = at > ray.from && at < ray.to && b1 >= -seam1 && b2 >= -seam2 && b1 + b2 <= T(1.0) + (seam1 + seam2),
        .meeting = {.at = at, .b1 = b1, .b2 = b2}};
}

}  // namespace lensproof::scene
