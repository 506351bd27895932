// engine/optics/surface_curvature.h — how a surface curves at a point: its gradient and second derivatives.
#pragma once
#include <array>
#include <cmath>

#include "engine/optics/surface_shape.h"

namespace lensproof::optics {

/// First and second derivatives of the function F whose zero the surface is (`implicit_surface`; of a conic
/// F = z − c (x² + y² + (1 + k) z²) / 2) at a point on it, in the surface's own axes. ∇F rises towards +z.
template <class T>
struct SurfaceDerivatives {
    Vec3<T> gradient;
    std::array<Vec3<T>, 3> hessian;  // rows
};

/// The profile's second derivative, with respect to r² twice. Those of A_1 and A_3 grow without bound towards the
/// vertex; there odd terms are left out, as r² times that of A_3 vanishes.
template <class T>
T sag_bend(const SurfaceShape<T>& shape, const T& r2) {
    using std::sqrt;
    const T& c = shape.curvature;
    const T flatness = T(1) + shape.conic;
    const T root2 = T(1) - flatness * c * c * r2;
    const T conic_bend = root2 > T(0) ? flatness * c * c * c / (T(4) * root2 * sqrt(root2)) : T(0);
    T bend = shape.along_normal ? T(0) : conic_bend;
    T power = T(1);  // r^(2i)
    for (int i = 1; i < shape.terms; ++i) {
        bend += T(i + 1) * T(i) * shape.asphere[i] * power;
        power *= r2;
    }
    if (shape.odd_terms > 0 && r2 > T(0)) {
        power = T(1) / (r2 * sqrt(r2));  // r^(j − 4)
        for (int i = 0; i < shape.odd_terms; ++i) {
            bend += (T(i) * T(i) - T(0.25)) * shape.odd_asphere[i] * power;
            power *= r2;
        }
    }
    if (!shape.along_normal) {
        return bend;
    }
    // (φ S)'' = φ (S'' + 2 g S' + (g² + g') S), where g = (ln φ)' = c² / (2 N D), φ² = N / D.
    const auto [secant, growth] = normal_secant(shape, r2, root2 > T(0));
    const SagProfile<T> departure = terms_profile(shape, r2);
    const T above = T(1) - shape.conic * c * c * r2;
    const T bent = growth * growth * (T(1) + T(2) * (shape.conic * root2 + flatness * above));
    return conic_bend + secant * (bend + T(2) * growth * departure.slope + bent * departure.sag);
}

template <class T>
SurfaceDerivatives<T> surface_derivatives(const SurfaceShape<T>& shape, const Vec3<T>& p) {
    const T& c = shape.curvature;
    if (shape.is_conic()) {
        const T flatness = T(1) + shape.conic;
        return {{-c * p.x, -c * p.y, T(1) - c * flatness * p.z},
                {{{-c, T(0), T(0)}, {T(0), -c, T(0)}, {T(0), T(0), -c * flatness}}}};
    }
    const Vec3<T> gradient = implicit_surface(shape, p).gradient;
    if (!shape.is_toroid) {
        const T r2 = p.x * p.x + p.y * p.y;
        const T slope = T(-2) * sag_profile(shape, r2).slope;
        const T bend = T(-4) * sag_bend(shape, r2);
        return {gradient,
                {{{slope + bend * p.x * p.x, bend * p.x * p.y, T(0)},
                  {bend * p.x * p.y, slope + bend * p.y * p.y, T(0)},
                  {T(0), T(0), T(0)}}}};
    }
    const T y2 = p.y * p.y;
    const SagProfile<T> g = sag_profile(shape, y2);
    const T g1 = T(2) * p.y * g.slope;                              // dg/dy
    const T g2 = T(2) * g.slope + T(4) * y2 * sag_bend(shape, y2);  // d²g/dy²
    const T& cx = shape.curvature_x;
    return {gradient, {{{-cx, T(0), T(0)}, {T(0), cx * g1 * g1 - g2 * (T(1) - cx * g.sag), T(0)}, {T(0), T(0), -cx}}}};
}

}  // namespace lensproof::optics
