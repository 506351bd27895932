// engine/optics/surface_shape.h — conics, even aspheres, toroids and cylinders: sag, and where a ray meets them.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/optics/intersect.h"

namespace lensproof {

/// A surface that is no sphere. In y–z it is the even asphere
///     g(y) = c y² / (1 + √(1 − (1 + k) c² y²)) + Σ A_2i y^2i,   i = 1 … 10
/// (Welford, Aberrations of Optical Systems, §4.5), turned about the axis, or, for a toroid, about the line parallel to
/// y through (0, 0, 1 / c_x): curvature c_x in x–z, 0 for a cylinder. Lengths in mm, the vertex is the origin.
template <class T>
struct SurfaceShape {
    T curvature = T(0);
    T conic = T(0);
    std::array<T, 10> asphere{};
    int terms = 0;  // how many of them may differ from 0
    bool is_toroid = false;
    T curvature_x = T(0);  // of a toroid

    /// Whether a quadratic gives the intersection.
    [[nodiscard]] bool is_conic() const { return terms == 0 && !is_toroid; }
};

/// The profile at r² and its derivative dg/d(r²). Beyond the equator of an ellipsoid, where there is no sag, `defined`
/// is false and the values are those of the conic's tangent cone there, finite.
template <class T>
struct SagProfile {
    T sag;
    T slope;         // dg / d(r²)
    T largest_term;  // of the sum, without its sign: its rounding is an ulp of this
    bool defined;
};

template <class T>
SagProfile<T> sag_profile(const SurfaceShape<T>& shape, const T& r2) {
    using std::abs;
    using std::max;
    using std::sqrt;
    const T& c = shape.curvature;
    const T root2 = T(1) - (T(1) + shape.conic) * c * c * r2;
    const bool defined = root2 > T(0);
    const T root = defined ? sqrt(root2) : T(0);
    T sag = c * r2 / (T(1) + root);
    T slope = defined ? c / (T(2) * root) : T(0);
    T power = T(1);  // r^(2i)
    T largest_term = T(0);
    for (int i = 0; i < shape.terms; ++i) {
        slope += T(i + 1) * shape.asphere[i] * power;
        power *= r2;
        const T term = shape.asphere[i] * power;
        sag += term;
        largest_term = max(largest_term, abs(term));
    }
    return {sag, slope, largest_term, defined};
}

/// The surface as the zero of F, which rises towards +z, with its gradient.
template <class T>
struct Implicit {
    T value;
    Vec3<T> gradient;
    T largest_term;  // of the profile
    bool defined;
};

/// F = z − g(r²), or for a toroid F = z − g − c_x (x² + z² − g²) / 2, the curvature form of x² + (z − R)² = (R − g)².
template <class T>
Implicit<T> implicit_surface(const SurfaceShape<T>& shape, const Vec3<T>& p) {
    if (!shape.is_toroid) {
        const SagProfile<T> g = sag_profile(shape, p.x * p.x + p.y * p.y);
        return {p.z - g.sag, {T(-2) * p.x * g.slope, T(-2) * p.y * g.slope, T(1)}, g.largest_term, g.defined};
    }
    const SagProfile<T> g = sag_profile(shape, p.y * p.y);
    const T& c = shape.curvature_x;
    return {p.z - g.sag - c / T(2) * (p.x * p.x + p.z * p.z - g.sag * g.sag),
            {-c * p.x, T(-2) * p.y * g.slope * (T(1) - c * g.sag), T(1) - c * p.z},
            g.largest_term,
            g.defined && T(1) - c * p.z > T(0)};
}

/// Where the surface is at (x, y): z above the vertex's plane. Not a number where there is no surface.
template <class T>
T sag(const SurfaceShape<T>& shape, const T& x, const T& y) {
    using std::sqrt;
    const SagProfile<T> g = sag_profile(shape, shape.is_toroid ? y * y : x * x + y * y);
    const T nowhere = std::numeric_limits<T>::quiet_NaN();
    if (!g.defined || !shape.is_toroid) {
        return g.defined ? g.sag : nowhere;
    }
    // c_x z² − 2 z + (2 g + c_x (x² − g²)) = 0, the root on the vertex's side.
    const T& c = shape.curvature_x;
    const T constant = T(2) * g.sag + c * (x * x - g.sag * g.sag);
    const T root2 = T(1) - c * constant;
    return root2 >= T(0) ? constant / (T(1) + sqrt(root2)) : nowhere;
}

/// Where a ray meets a conic, and ∇F there, towards +z; without the sine, which `intersect` adds.
///
/// c (x² + y² + (1 + k) z²) − 2 z = 0 along the ray from its closest approach p to the vertex (p·d = 0) is
///     A s² − 2 B s + C = 0,   A = c (1 + k d_z²),   B = d_z (1 − c k p_z),   C = f + c k p_z²,   f = c p·p − 2 p_z,
/// and d·∇F at a root is B − A s = ±√(B² − A C), so the heading picks the root as it does for the sphere. In B² − A C
/// the terms k² c² p_z² d_z² and 2 k c p_z d_z² stand twice; without them it is the sphere's discriminant and one term
/// more, d_z² − c f − c² k (p_z² + d_z² p·p), which is still good to an ulp at k = 1e6. p is projected twice, for far
/// origins: with k the linear term is too long to carry what rounding leaves of p·d.
///
/// Second, ∇F = (−c x, −c y, 1 − c (1 + k) z). Its z is √(1 − (1 + k) c² r²) as well, which does not amplify the error
/// of z by k; it stands where the root is no small difference, the other form near an ellipsoid's equator.
template <class T>
std::pair<Intersection<T>, Vec3<T>> intersect_conic(const Vec3<T>& origin, const Vec3<T>& d, const T& c, const T& k,
                                                    const T& heading) {
    using std::sqrt;
    const T first = -dot(origin, d);
    const Vec3<T> near_vertex = origin + first * d;
    const T second = -dot(near_vertex, d);
    const Vec3<T> p = near_vertex + second * d;
    const T to_vertex = first + second;
    const T p2 = dot(p, p);
    const T f = c * p2 - T(2) * p.z;
    const T a = c * (T(1) + k * d.z * d.z);
    const T b = d.z * (T(1) - c * k * p.z);
    const T constant = f + c * k * p.z * p.z;
    const T discriminant = d.z * d.z - c * f - c * c * k * (p.z * p.z + d.z * d.z * p2);
    const bool meets = discriminant > T(0);
    const T root = sqrt(meets ? discriminant : T(1));
    const bool along = b * heading > T(0);
    const bool curved = a < T(0) || a > T(0);
    const T q = b + (along ? heading : -heading) * root;
    const T s = (along ? constant : q) / (along ? q : (curved ? a : T(1)));
    const Vec3<T> point = p + s * d;
    const T of_z = T(1) - c * (T(1) + k) * point.z;
    const T across = c * c * (point.x * point.x + point.y * point.y);
    const T of_r2 = T(1) - (T(1) + k) * across;
    const T gradient_z = T(4) * of_r2 > T(1) ? sqrt(of_r2) : of_z;
    return {{.point = point,
             .distance = to_vertex + s,
             .cos_incidence = root / sqrt(across + gradient_z * gradient_z),
             .sin2_incidence = T(0),
             .hit = meets && (along || curved) && of_z > T(0)},
            {-c * point.x, -c * point.y, gradient_z}};
}

/// Newton's method along a ray from the point at `start` (mm) to where it crosses `shape` in the heading's sense, until
/// a step is below the precision of T. A step to where there is no surface, or where the ray runs the other way through
/// it, is halved. `hit` is false where that leads nowhere; cosine and sine are left to the caller.
template <class T>
std::pair<Intersection<T>, Vec3<T>> newton_intersect(const SurfaceShape<T>& shape, const Vec3<T>& origin,
                                                     const Vec3<T>& d, const T& heading, const T& start) {
    using std::abs;
    using std::sqrt;
    // A step that no longer shrinks has come down to the noise of the terms' sum.
    constexpr int kMostSteps = 60;
    const T precision = T(16) * std::numeric_limits<T>::epsilon();
    Intersection<T> meeting{
        .point = origin + start * d, .distance = start, .cos_incidence = T(1), .sin2_incidence = T(0), .hit = false};
    Vec3<T> gradient{T(0), T(0), T(1)};
    T ahead = T(0);
    T last_step = std::numeric_limits<T>::infinity();
    for (int step = 0; step < kMostSteps && !meeting.hit; ++step) {
        const Implicit<T> here = implicit_surface(shape, meeting.point);
        const T rise = dot(here.gradient, d);
        if (!here.defined || !(rise * heading > T(0))) {
            ahead = ahead / T(2);
            if (!(abs(ahead) > T(0))) {
                break;
            }
            meeting.point = meeting.point - ahead * d;
            meeting.distance -= ahead;
            continue;
        }
        ahead = -here.value / rise;
        meeting.point = meeting.point + ahead * d;
        meeting.distance += ahead;
        const T size = sqrt(dot(meeting.point, meeting.point)) + T(1);
        const bool is_noise = abs(ahead) >= last_step && abs(ahead) <= T(4) * precision * (size + here.largest_term);
        meeting.hit = abs(ahead) <= precision * size || is_noise;
        last_step = abs(ahead);
        gradient = here.gradient;
    }
    return {meeting, gradient};
}

/// `intersect` for any shape. What is no conic is found by Newton's method: from the conic's intersection (not a
/// toroid's), else from the vertex's plane, else from seven points of the ray around that nearest to the vertex. A
/// surface that turns over may be met more than once; the root found is then the one next to the start. Returned with
/// the unit normal there, turned along the ray.
template <class T>
std::pair<Intersection<T>, Vec3<T>> intersect(const SurfaceShape<T>& shape, const Vec3<T>& origin, const Vec3<T>& d,
                                              const T& heading) {
    using std::sqrt;
    const auto with_normal = [&](Intersection<T> met, const Vec3<T>& gradient) {
        const Vec3<T> normal = heading / sqrt(dot(gradient, gradient)) * gradient;
        const Vec3<T> across = d - met.cos_incidence * normal;
        met.sin2_incidence = dot(across, across);
        return std::pair{met, normal};
    };
    const auto conic_met = intersect_conic(origin, d, shape.curvature, shape.conic, heading);
    const Intersection<T>& conic = conic_met.first;
    if (shape.is_conic()) {
        return with_normal(conic, conic_met.second);
    }
    const T nearest = -dot(origin, d);
    const T across = length(origin + nearest * d);
    const bool crosses_plane = d.z < T(0) || d.z > T(0);
    std::pair<Intersection<T>, Vec3<T>> found{};
    const auto finds_from = [&](const T& start) {
        found = newton_intersect(shape, origin, d, heading, start);
        return found.first.hit;
    };
    const auto finds_from_any = [&] {
        if (!shape.is_toroid && conic.hit && finds_from(conic.distance)) {
            return true;
        }
        if (crosses_plane && finds_from(-origin.z / d.z)) {
            return true;
        }
        for (const int share : {0, 2, -2, 1, -1, 4, -4}) {
            if (finds_from(nearest + T(share) / T(2) * across)) {
                return true;
            }
        }
        return false;
    };
    if (!finds_from_any()) {
        found.first.hit = false;
        found.second = {T(0), T(0), heading};
    }
    found.first.cos_incidence = heading * dot(d, found.second) / sqrt(dot(found.second, found.second));
    return with_normal(found.first, found.second);
}

}  // namespace lensproof
