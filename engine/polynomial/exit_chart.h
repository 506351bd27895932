// engine/polynomial/exit_chart.h — rays in front of a lens as four numbers, without a singular one among them.
#pragma once
#include <cmath>

#include "engine/base/ray.h"
#include "engine/base/vec.h"

namespace lensproof::polynomial {

/// A ray by where it crosses the sphere of curvature c (1/mm; flat: 0) about the lens's front vertex, and by its
/// direction outwards, each projected stereographically:
///
///     u = o_⊥ / (2 − c o_z),   o = (2 u, 2 c u·u) / (1 + c² u·u);
///     w = d_⊥ / (1 − d_z),     d = (2 w, w·w − 1) / (1 + w·w).
///
/// So w is tan(θ/2) for a field angle θ: 1 at 90°, finite up to 180°, and the direction has unit length whatever w is.
/// Half of u is the same of the angle at the sphere's centre. Neither has a root, and u = o_⊥/2 where c = 0.
template <class T>
struct ExitPoint {
    Vec2<T> u;  // mm
    Vec2<T> w;
};

template <class T>
ExitPoint<T> exit_point(const Ray<T>& outwards, const T& curvature) {
    const T per_u = T(1) / (T(2) - curvature * outwards.origin.z);
    const T per_w = T(1) / (T(1) - outwards.direction.z);
    return {.u = {per_u * outwards.origin.x, per_u * outwards.origin.y},
            .w = {per_w * outwards.direction.x, per_w * outwards.direction.y}};
}

template <class T>
Ray<T> exit_ray(const ExitPoint<T>& at, const T& curvature) {
    const T u2 = dot(at.u, at.u);
    const T w2 = dot(at.w, at.w);
    const T of_u = T(2) / (T(1) + curvature * curvature * u2);
    const T of_w = T(1) / (T(1) + w2);
    return {{of_u * at.u.x, of_u * at.u.y, of_u * (curvature * u2)},
            {T(2) * of_w * at.w.x, T(2) * of_w * at.w.y, of_w * (w2 - T(1))}};
}

/// The ray's etendue per du dw, mm² sr/mm²: dA = 4 du / (1 + c² u·u)², dω = 4 dw / (1 + w·w)², and the cosine
/// between the direction and the sphere's normal.
inline double etendue_density(const ExitPoint<double>& at, double curvature) {
    const Ray<double> ray = exit_ray(at, curvature);
    const Vec3d normal{-curvature * ray.origin.x, -curvature * ray.origin.y, 1.0 - curvature * ray.origin.z};
    const double of_u = 1.0 + curvature * curvature * dot(at.u, at.u);
    const double of_w = 1.0 + dot(at.w, at.w);
    return std::abs(dot(ray.direction, normal)) * 16.0 / (of_u * of_u * of_w * of_w);
}

}  // namespace lensproof::polynomial
