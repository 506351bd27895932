// engine/optics/surface_shape.h — conics, aspheres, toroids and cylinders: sag, and where a ray meets them.
#pragma once
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/optics/intersect.h"

namespace lensproof::optics {

/// A surface that is no sphere. In y–z it is the asphere
///     g(y) = c y² / (1 + √(1 − (1 + k) c² y²)) + Σ A_j |y|^j,   j = 1 … 20
/// (Welford, Aberrations of Optical Systems, §4.5), turned about the axis, or, for a toroid, about the line parallel to
/// y through (0, 0, 1 / c_x): curvature c_x in x–z, 0 for a cylinder. Lengths in mm, the vertex is the origin.
///
/// Even and odd powers stand apart, for most aspheres have none of the latter. A_1 makes a cone, whose tip has no
/// normal: the axis is taken there. A_3 bends nothing at the vertex, but the third derivative jumps.
///
/// `along_normal`: the terms count along the conic's normal, to first order, as in Forbes's mild aspheres: their sum is
/// multiplied by 1 / cos of the normal's angle with the axis, √((1 − k c² y²) / (1 − (1 + k) c² y²)).
template <class T>
struct SurfaceShape {
    T curvature = T(0);
    T conic = T(0);
    std::array<T, 10> asphere{};      // A_2, A_4, … A_20
    int terms = 0;                    // how many of them may differ from 0
    std::array<T, 10> odd_asphere{};  // A_1, A_3, … A_19
    int odd_terms = 0;
    bool along_normal = false;
    bool is_toroid = false;
    T curvature_x = T(0);  // of a toroid

    /// Whether a quadratic gives the intersection.
    [[nodiscard]] constexpr bool is_conic() const { return terms == 0 && odd_terms == 0 && !is_toroid; }
};

/// The profile at r² and its derivative dg/d(r²). Beyond the equator of an ellipsoid, where there is no sag, `defined`
/// is false and the values are those of the conic's tangent cone there, finite.
///
/// Here and below a shape's numbers are single ones (Scalar) and a ray's are T: the same type, or a pack of it, of
/// which each lane has the bits that it would have alone.
template <class T>
struct SagProfile {
    T sag;
    T slope;         // dg / d(r²)
    T largest_term;  // of the sum, without its sign: its rounding is an ulp of this
    MaskOf<T> defined;
};

/// Adds Σ A_j r^j of the odd j to a profile.
template <class Scalar, class T>
constexpr void add_odd_terms(const SurfaceShape<Scalar>& shape, const T& r2, SagProfile<T>& profile) {
    using std::abs;
    using std::sqrt;
    const auto off_axis = r2 > T(0);
    const T r = sqrt(select(off_axis, r2, T(1)));
    T power = select(off_axis, T(1) / r, T(0));  // r^(j − 2)
    for (int i = 0; i < shape.odd_terms; ++i) {
        profile.slope = profile.slope + T((Scalar(i) + Scalar(0.5)) * shape.odd_asphere[i]) * power;
        power = i == 0 ? select(off_axis, r, T(0)) : power * r2;
        const T term = T(shape.odd_asphere[i]) * power;
        profile.sag = profile.sag + term;
        profile.largest_term = select(profile.largest_term < abs(term), abs(term), profile.largest_term);
    }
}

/// The profile with its terms along the axis.
template <class Scalar, class T>
constexpr SagProfile<T> axial_profile(const SurfaceShape<Scalar>& shape, const T& r2) {
    using std::abs;
    using std::sqrt;
    const Scalar& c = shape.curvature;
    const T root2 = T(1) - T((Scalar(1) + shape.conic) * c * c) * r2;
    const auto defined = root2 > T(0);
    const T root = sqrt(select(defined, root2, T(1)));
    T sag = T(c) * r2 / (T(1) + select(defined, root, T(0)));
    T slope = select(defined, T(c) / (T(2) * root), T(0));
    T power = T(1);  // r^(2i)
    T largest_term = T(0);
    for (int i = 0; i < shape.terms; ++i) {
        slope = slope + T(Scalar(i + 1) * shape.asphere[i]) * power;
        power = power * r2;
        const T term = T(shape.asphere[i]) * power;
        sag = sag + term;
        largest_term = select(largest_term < abs(term), abs(term), largest_term);
    }
    SagProfile<T> profile{sag, slope, largest_term, defined};
    if (shape.odd_terms > 0) {
        add_odd_terms(shape, r2, profile);
    }
    return profile;
}

/// The terms alone, on a plane, along the axis.
template <class Scalar, class T>
constexpr SagProfile<T> terms_profile(SurfaceShape<Scalar> shape, const T& r2) {
    shape.curvature = Scalar(0);
    return axial_profile(shape, r2);
}

/// 1 / cos of the angle of a conic's normal with the axis, φ, and its logarithm's derivative dlnφ / d(r²). 1 and 0
/// outside `defined`, where there is no conic.
template <class Scalar, class T>
constexpr std::pair<T, T> normal_secant(const SurfaceShape<Scalar>& shape, const T& r2, const MaskOf<T>& defined) {
    using std::sqrt;
    const Scalar c2 = shape.curvature * shape.curvature;
    const T above = select(defined, T(1) - T(shape.conic * c2) * r2, T(1));
    const T below = select(defined, T(1) - T((Scalar(1) + shape.conic) * c2) * r2, T(1));
    return {sqrt(above / below), select(defined, T(c2 / Scalar(2)) / (above * below), T(0))};
}

/// The profile with its terms along the conic's normal. By itself, and called with a value, since what is put into the
/// other's inner loop, or only takes addresses there, costs every asphere a tenth.
template <class Scalar, class T>
[[gnu::noinline]] constexpr SagProfile<T> profile_along_normal(const SurfaceShape<Scalar>& shape, T r2) {
    const SurfaceShape<Scalar> bare{.curvature = shape.curvature, .conic = shape.conic};
    const SagProfile<T> conic = axial_profile(bare, r2);
    const SagProfile<T> terms = terms_profile(shape, r2);
    const auto [secant, growth] = normal_secant(shape, r2, conic.defined);
    return {conic.sag + secant * terms.sag, conic.slope + secant * (terms.slope + growth * terms.sag),
            secant * terms.largest_term, conic.defined};
}

template <class Scalar, class T>
constexpr SagProfile<T> sag_profile(const SurfaceShape<Scalar>& shape, const T& r2) {
    return shape.along_normal ? profile_along_normal(shape, r2) : axial_profile(shape, r2);
}

/// The surface as the zero of F, which rises towards +z, with its gradient.
template <class T>
struct Implicit {
    T value;
    Vec3<T> gradient;
    T largest_term;  // of the profile
    MaskOf<T> defined;
};

/// F = z − g(r²), or for a toroid F = z − g − c_x (x² + z² − g²) / 2, the curvature form of x² + (z − R)² = (R − g)².
template <class Scalar, class T>
constexpr Implicit<T> implicit_surface(const SurfaceShape<Scalar>& shape, const Vec3<T>& p) {
    if (!shape.is_toroid) {
        const SagProfile<T> g = sag_profile(shape, p.x * p.x + p.y * p.y);
        return {p.z - g.sag, {T(-2) * p.x * g.slope, T(-2) * p.y * g.slope, T(1)}, g.largest_term, g.defined};
    }
    const SagProfile<T> g = sag_profile(shape, p.y * p.y);
    const T c(shape.curvature_x);
    return {p.z - g.sag - c / T(2) * (p.x * p.x + p.z * p.z - g.sag * g.sag),
            {-c * p.x, T(-2) * p.y * g.slope * (T(1) - c * g.sag), T(1) - c * p.z},
            g.largest_term,
            g.defined && T(1) - c * p.z > T(0)};
}

/// Where the surface is at (x, y): z above the vertex's plane. Not a number where there is no surface.
template <class Scalar, class T>
constexpr T sag(const SurfaceShape<Scalar>& shape, const T& x, const T& y) {
    using std::sqrt;
    const SagProfile<T> g = sag_profile(shape, shape.is_toroid ? y * y : x * x + y * y);
    const T nowhere(std::numeric_limits<Scalar>::quiet_NaN());
    if (!shape.is_toroid) {
        return select(g.defined, g.sag, nowhere);
    }
    // c_x z² − 2 z + (2 g + c_x (x² − g²)) = 0, the root on the vertex's side.
    const T c(shape.curvature_x);
    const T constant = T(2) * g.sag + c * (x * x - g.sag * g.sag);
    const T root2 = T(1) - c * constant;
    const auto is_there = root2 >= T(0);
    return select(g.defined && is_there, constant / (T(1) + sqrt(select(is_there, root2, T(1)))), nowhere);
}

/// Where a ray meets a conic.
template <class T>
struct ConicRoot {
    Vec3<T> point;
    T distance;        // along the ray, signed, mm
    T gradient_along;  // |d·∇F|
    T gradient_z;
    MaskOf<T> hit;
};

/// c (x² + y² + (1 + k) z²) − 2 z = 0 along the ray from its closest approach p to the vertex (p·d = 0) is
///     A s² − 2 B s + C = 0,   A = c (1 + k d_z²),   B = d_z (1 − c k p_z),   C = f + c k p_z²,   f = c p·p − 2 p_z,
/// and d·∇F at a root is B − A s = ±√(B² − A C), so the heading picks the root as it does for the sphere. In B² − A C
/// the terms k² c² p_z² d_z² and 2 k c p_z d_z² stand twice; without them it is the sphere's discriminant and one term
/// more, d_z² − c f − c² k (p_z² + d_z² p·p), which is still good to an ulp at k = 1e6. p is projected twice, for far
/// origins: with k the linear term is too long to carry what rounding leaves of p·d.
///
/// Here and in `axial_profile` the word `inline` is worth a tenth of an asphere's time: g++ 12 weighs it.
template <class T>
constexpr ConicRoot<T> conic_root(const Vec3<T>& origin, const Vec3<T>& d, const T& c, const T& k, const T& heading) {
    using std::sqrt;
    const T first = -dot(origin, d);
    const Vec3<T> near_vertex = origin + first * d;
    const T second = -dot(near_vertex, d);
    const Vec3<T> p = near_vertex + second * d;
    const T p2 = dot(p, p);
    const T f = c * p2 - T(2) * p.z;
    const T a = c * (T(1) + k * d.z * d.z);
    const T b = d.z * (T(1) - c * k * p.z);
    const T constant = f + c * k * p.z * p.z;
    const T discriminant = d.z * d.z - c * f - c * c * k * (p.z * p.z + d.z * d.z * p2);
    const auto meets = discriminant > T(0);
    const T root = sqrt(select(meets, discriminant, T(1)));
    const auto along = b * heading > T(0);
    const auto curved = a < T(0) || a > T(0);
    const T q = b + select(along, heading, -heading) * root;
    const T s = select(along, constant, q) / select(along, q, select(curved, a, T(1)));
    const Vec3<T> point = p + s * d;
    const T gradient_z = T(1) - c * (T(1) + k) * point.z;
    return {point, first + second + s, root, gradient_z, meets && (along || curved) && gradient_z > T(0)};
}

/// Where a ray meets a conic, and ∇F = (−c x, −c y, 1 − c (1 + k) z) there, towards +z; without the sine, which
/// `intersect` adds. ∇F's z is √(1 − (1 + k) c² r²) as well, which does not amplify the error of z by k; it stands
/// where the root is no small difference, the other form near an ellipsoid's equator.
template <class T>
constexpr std::pair<Intersection<T>, Vec3<T>> intersect_conic(const Vec3<T>& origin, const Vec3<T>& d, const T& c,
                                                              const T& k, const T& heading) {
    using std::sqrt;
    const ConicRoot<T> met = conic_root(origin, d, c, k, heading);
    const Vec3<T>& point = met.point;
    const T across = c * c * (point.x * point.x + point.y * point.y);
    const T of_r2 = T(1) - (T(1) + k) * across;
    const auto is_plain = T(4) * of_r2 > T(1);
    const T gradient_z = select(is_plain, sqrt(select(is_plain, of_r2, T(1))), met.gradient_z);
    return {{.point = point,
             .distance = met.distance,
             .cos_incidence = met.gradient_along / sqrt(across + gradient_z * gradient_z),
             .sin2_incidence = T(0),
             .hit = met.hit},
            {-c * point.x, -c * point.y, gradient_z}};
}

/// A point of a ray on a surface, and ∇F there.
template <class T>
struct ShapeCrossing {
    Vec3<T> point;
    T distance;  // along the ray, signed, mm
    Vec3<T> gradient;
    MaskOf<T> found;
};

using lensproof::assign_where;
template <Packet T>
constexpr void assign_where(const MaskOf<T>& mask, ShapeCrossing<T>& to, const ShapeCrossing<T>& value) {
    to = {select(mask, value.point, to.point), select(mask, value.distance, to.distance),
          select(mask, value.gradient, to.gradient), (mask && value.found) || (!mask && to.found)};
}

/// Newton's method along a ray from the point at `start` (mm) to where it crosses `shape` in the heading's sense, until
/// a step is below the precision of the numbers. A step to where there is no surface, or where the ray crosses in
/// the other sense, is halved. `found` is false where that leads nowhere. Lanes outside `wanted` are not waited for,
/// and are not found; a lane that has arrived stays while others go on.
template <class Scalar, class T>
constexpr ShapeCrossing<T> newton_intersect(const SurfaceShape<Scalar>& shape, const Vec3<T>& origin, const Vec3<T>& d,
                                            const T& heading, const T& start, const MaskOf<T>& wanted) {
    using std::abs;
    using std::sqrt;
    constexpr int kMostSteps = 60;
    const T precision(Scalar(16) * std::numeric_limits<Scalar>::epsilon());
    ShapeCrossing<T> at{
        .point = origin + start * d, .distance = start, .gradient = {T(0), T(0), T(1)}, .found = MaskOf<T>(false)};
    T ahead(0);
    T last_step(std::numeric_limits<Scalar>::infinity());
    MaskOf<T> active = wanted;
    for (int step = 0; step < kMostSteps && any(active); ++step) {
        const Implicit<T> here = implicit_surface(shape, at.point);
        const T rise = dot(here.gradient, d);
        const auto crosses = here.defined && rise * heading > T(0);
        ahead = select(crosses, -here.value / select(crosses, rise, T(1)), ahead / T(2));
        const T length_ahead = abs(ahead);
        active = active && (crosses || length_ahead > T(0));
        if (!any(active)) {
            break;
        }
        const T move = select(crosses, ahead, -ahead);
        at.point = select(active, at.point + move * d, at.point);
        at.distance = select(active, at.distance + move, at.distance);
        at.gradient = select(active && crosses, here.gradient, at.gradient);
        // A step that no longer shrinks has come down to the noise of the terms' sum.
        const T size = sqrt(dot(at.point, at.point)) + T(1);
        const auto is_noise =
            length_ahead >= last_step && length_ahead <= T(4) * precision * (size + here.largest_term);
        const auto arrives = active && crosses && (length_ahead <= precision * size || is_noise);
        last_step = select(crosses, length_ahead, last_step);
        at.found = at.found || arrives;
        active = active && !arrives;
    }
    return at;
}

/// Where a ray crosses a shape that is no conic, by Newton's method: from the conic's intersection (not a toroid's),
/// else from the vertex's plane, else from seven points of the ray around that nearest to the vertex.
template <class Scalar, class T>
constexpr ShapeCrossing<T> find_crossing(const SurfaceShape<Scalar>& shape, const Vec3<T>& origin, const Vec3<T>& d,
                                         const T& heading) {
    ShapeCrossing<T> crossing{};
    MaskOf<T> sought(true);
    const auto try_from = [&](const T& start, const MaskOf<T>& where) {
        const MaskOf<T> tried = sought && where;
        if (any(tried)) {
            assign_where(tried, crossing, newton_intersect(shape, origin, d, heading, start, tried));
            sought = sought && !crossing.found;
        }
    };
    if (!shape.is_toroid) {
        const ConicRoot<T> conic = conic_root(origin, d, T(shape.curvature), T(shape.conic), heading);
        try_from(conic.distance, conic.hit);
    }
    if (any(sought)) {
        const auto crosses_plane = d.z < T(0) || d.z > T(0);
        try_from(-origin.z / select(crosses_plane, d.z, T(1)), crosses_plane);
    }
    if (any(sought)) {
        const T nearest = -dot(origin, d);
        const T across = length(origin + nearest * d);
        for (const int halves : {0, 2, -2, 1, -1, 4, -4}) {
            try_from(nearest + T(halves) / T(2) * across, sought);
        }
    }
    crossing.gradient = select(crossing.found, crossing.gradient, Vec3<T>{T(0), T(0), heading});
    return crossing;
}

/// `intersect` for any shape. A surface that turns over may be met more than once; the root found is then the one next
/// to the start (`find_crossing`). Returned with the unit normal there, turned along the ray.
template <class Scalar, class T>
constexpr std::pair<Intersection<T>, Vec3<T>> intersect(const SurfaceShape<Scalar>& shape, const Vec3<T>& origin,
                                                        const Vec3<T>& d, const T& heading) {
    using std::sqrt;
    const auto meeting = [&](const Vec3<T>& point, const T& distance, const T& cos_incidence, const Vec3<T>& gradient,
                             const MaskOf<T>& hit) {
        const Vec3<T> normal = heading / sqrt(dot(gradient, gradient)) * gradient;
        const Vec3<T> across = d - cos_incidence * normal;
        return std::pair{Intersection<T>{point, distance, cos_incidence, dot(across, across), hit}, normal};
    };
    if (shape.is_conic()) {
        const auto [met, gradient] = intersect_conic(origin, d, T(shape.curvature), T(shape.conic), heading);
        return meeting(met.point, met.distance, met.cos_incidence, gradient, met.hit);
    }
    const ShapeCrossing<T> met = find_crossing(shape, origin, d, heading);
    const Vec3<T>& gradient = met.gradient;
    const T cos_incidence = heading * dot(d, gradient) / sqrt(dot(gradient, gradient));
    return meeting(met.point, met.distance, cos_incidence, gradient, met.found);
}

}  // namespace lensproof::optics
