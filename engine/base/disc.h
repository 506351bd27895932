// engine/base/disc.h — a disc, and how to draw points evenly from it.
#pragma once
#include <cmath>
#include <numbers>

#include "engine/base/elementary.h"
#include "engine/base/select.h"
#include "engine/base/vec.h"

namespace lensproof {

/// The point of a disc around the origin that (u, v) in the unit square maps to, evenly (Shirley & Chiu, J. Graphics
/// Tools 2(3), 1997). Of doubles, or packets of them.
template <class T>
constexpr Vec2<T> warped_onto_disc(const T& radius, const T& u, const T& v) {
    const T zero(0.0);
    const T a = T(2.0) * u - T(1.0);
    const T b = T(2.0) * v - T(1.0);
    const auto is_wide = a * a > b * b;
    const T larger = select(is_wide, a, b);
    const auto is_off_centre = larger < zero || larger > zero;
    const T angle = T(0.25 * std::numbers::pi) * select(is_wide, b, a) / select(is_off_centre, larger, T(1.0));
    const Vec2<T> turn = cos_sin_within_eighth(angle);
    const T along = radius * larger * turn.x;
    const T across = radius * larger * turn.y;
    return {select(is_wide, along, across), select(is_wide, across, along)};
}

/// A direction of z > 0 with the pdf z / π per solid angle: a point of the unit disc, lifted onto the hemisphere
/// (Malley).
template <class T>
Vec3<T> cosine_direction(const T& u1, const T& u2) {
    using std::sqrt;
    const Vec2<T> at = warped_onto_disc(T(1.0), u1, u2);
    const T left = T(1.0) - dot(at, at);
    return {at.x, at.y, sqrt(select(left > T(0.0), left, T(0.0)))};
}

/// A disc around the origin of its plane, mm.
struct Disc {
    double radius = 0.0;

    [[nodiscard]] constexpr double area() const { return std::numbers::pi * radius * radius; }
    [[nodiscard]] constexpr bool contains(Vec2d point) const { return dot(point, point) <= radius * radius; }
    [[nodiscard]] constexpr Vec2d warped(double u, double v) const { return warped_onto_disc(radius, u, v); }
};

}  // namespace lensproof
