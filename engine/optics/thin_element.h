// engine/optics/thin_element.h — what bends light at a surface beside the two media: an ideal lens, or a phase, as
// gratings and kinoforms have it.
#pragma once
#include <array>
#include <cmath>

#include "engine/base/select.h"
#include "engine/base/vec.h"

namespace lensproof::optics {

enum class ThinKind { none, ideal_lens, phase };

/// Coefficients of r², r⁴, … r²⁰ of a phase.
inline constexpr int kPhaseTerms = 10;

/// A surface's thin element at one wavelength; mm. What either kind adds to the optical path is added behind the
/// surface.
///
/// An ideal lens, on a plane, makes of every point a point: with slopes m = (dx/dz, dy/dz) of a ray at p = (x, y),
///     n' m' = n m − φ p
/// (Gauss's equation, at any angle). No path that depends on p and m alone makes the waves of all object points
/// perfect (Maxwell; Born & Wolf, §4.2.2), so it is that of one object plane, whose z from the lens is 1/v:
///     Δ = (n |P| − n |P − p|) + (n' |P'| − n' |P' − p|),
/// P and P' the object point and its image on this ray, so that each ray of P takes as long as the one through the
/// vertex.
///
/// A phase adds the path W(x, y) = g y + Σ a_i r^(2i), and its gradient to the optical direction cosines along the
/// surface, n' d' − n d = ∇W there (Welford, Aberrations of Optical Systems, §5.5). A grating with N lines a mm along
/// x, equally spaced in projection, has g = m N λ in the order m. Efficiency is not modelled: all light goes there.
template <class T>
struct ThinElement {
    ThinKind kind = ThinKind::none;
    T power = T(0);                       // φ of an ideal lens, 1/mm: with air on both sides 1/f
    T object_vergence = T(0);             // v, 1/mm; 0: the object is far, negative: it stands in front
    T linear = T(0);                      // g
    std::array<T, kPhaseTerms> radial{};  // a_1, …, mm^(1−2i)

    /// φ of n' u' = n u − φ y near the axis, 1/mm. What a grating turns the axis by is left out.
    [[nodiscard]] constexpr T first_order_power() const { return power - T(2) * radial[0]; }
};

/// A ray at the surface, in its own axes: the media are those in front of and behind the ray, whichever way it runs.
template <class T>
struct ThinMeeting {
    Vec3<T> point;      // from the vertex
    Vec3<T> direction;  // of unit length
    Vec3<T> normal;     // likewise, turned along the ray
    T cos_incidence;
    T index_before;
    T index_after;
    T heading;  // 1 towards the sensor, −1 from there
};

/// What becomes of it. Where `passes` is false (an order that is evanescent) the numbers are meaningless.
template <class T>
struct ThinBending {
    Vec3<T> direction;
    T optical_path;  // that is added
    MaskOf<T> passes;
};

namespace thin_detail {

/// |(q, 1)|.
template <class T>
constexpr T length_beside(const Vec2<T>& q) {
    using std::sqrt;
    return sqrt(q.x * q.x + q.y * q.y + T(1));
}

/// n |P| − n |P − p| of the point P on a ray through p whose z is 1/v, P − p being (m, 1) / v: of one formula with v =
/// 0, where P is far off and this is how much earlier its wave is at p.
template <class T>
constexpr T ahead_of_vertex(const T& index, const T& v, const Vec2<T>& p, const Vec2<T>& m) {
    const Vec2<T> from_vertex{m.x + v * p.x, m.y + v * p.y};
    return -index * (T(2) * (p.x * m.x + p.y * m.y) + v * (p.x * p.x + p.y * p.y)) /
           (length_beside(from_vertex) + length_beside(m));
}

}  // namespace thin_detail

template <class Scalar, class T>
constexpr ThinBending<T> bend_at_ideal_lens(const ThinElement<Scalar>& lens, const ThinMeeting<T>& at) {
    using thin_detail::ahead_of_vertex;
    const T power(lens.power);
    const Vec2<T> p{at.point.x, at.point.y};
    const Vec2<T> before{at.direction.x / at.direction.z, at.direction.y / at.direction.z};
    const T turn = at.heading * power;
    const Vec2<T> after{(at.index_before * before.x - turn * p.x) / at.index_after,
                        (at.index_before * before.y - turn * p.y) / at.index_after};
    const T along_z = at.heading / thin_detail::length_beside(after);
    const auto forward = at.heading > T(0);
    const T index_of_scene = select(forward, at.index_before, at.index_after);
    const T index_of_sensor = select(forward, at.index_after, at.index_before);
    const T v(lens.object_vergence);
    const T v_image = (index_of_scene * v + power) / index_of_sensor;
    const Vec2<T> of_scene{select(forward, before.x, after.x), select(forward, before.y, after.y)};
    const Vec2<T> of_sensor{select(forward, after.x, before.x), select(forward, after.y, before.y)};
    const T added =
        ahead_of_vertex(index_of_scene, v, p, of_scene) - ahead_of_vertex(index_of_sensor, v_image, p, of_sensor);
    return {{along_z * after.x, along_z * after.y, along_z}, added, MaskOf<T>(true)};
}

/// Sums over a radial phase: W, dW/d(r²) and d²W/d(r²)².
template <class T>
struct RadialPhase {
    T path = T(0);
    T slope = T(0);
    T bend = T(0);
};

template <class T>
constexpr RadialPhase<T> radial_phase(const std::array<T, kPhaseTerms>& radial, const T& r2) {
    RadialPhase<T> phase;
    for (int i = kPhaseTerms - 1; i >= 0; --i) {
        const T& a = radial[static_cast<std::size_t>(i)];
        phase.path = (phase.path + a) * r2;
        phase.slope = phase.slope * r2 + T(i + 1) * a;
        if (i > 0) {
            phase.bend = phase.bend * r2 + T(i + 1) * T(i) * a;
        }
    }
    return phase;
}

/// (∂W/∂x, ∂W/∂y, 0) at a point, and how it changes over a shift from there; in the surface's own axes.
template <class T>
constexpr Vec3<T> phase_gradient(const ThinElement<T>& element, const Vec3<T>& p) {
    const T twice_slope = T(2) * radial_phase(element.radial, T(p.x * p.x + p.y * p.y)).slope;
    return {twice_slope * p.x, twice_slope * p.y + element.linear, T(0)};
}
template <class T>
constexpr Vec3<T> phase_gradient_turn(const ThinElement<T>& element, const Vec3<T>& p, const Vec3<T>& shift) {
    const RadialPhase<T> phase = radial_phase(element.radial, T(p.x * p.x + p.y * p.y));
    const T along = T(4) * phase.bend * (p.x * shift.x + p.y * shift.y);
    return {T(2) * phase.slope * shift.x + along * p.x, T(2) * phase.slope * shift.y + along * p.y, T(0)};
}

/// `linear` and `radial` may differ from ray to ray, as their wavelengths do.
template <class T>
constexpr ThinBending<T> bend_at_phase(const T& linear, const std::array<T, kPhaseTerms>& radial,
                                       const ThinMeeting<T>& at) {
    using std::sqrt;
    const T r2 = at.point.x * at.point.x + at.point.y * at.point.y;
    const RadialPhase<T> phase = radial_phase(radial, r2);
    const Vec3<T> gradient{T(2) * phase.slope * at.point.x, T(2) * phase.slope * at.point.y + linear, T(0)};
    const Vec3<T> optical = at.index_before * (at.direction - at.cos_incidence * at.normal) +
                            (gradient - dot(gradient, at.normal) * at.normal);
    const Vec3<T> along = (T(1) / at.index_after) * optical;
    const T squared = T(1) - dot(along, along);
    const auto passes = squared > T(0);
    const T cosine = sqrt(select(passes, squared, T(1)));
    return {along + cosine * at.normal, phase.path + linear * at.point.y, passes};
}

/// For rays of one wavelength.
template <class Scalar, class T>
constexpr ThinBending<T> bend_at(const ThinElement<Scalar>& element, const ThinMeeting<T>& at) {
    if (element.kind == ThinKind::ideal_lens) {
        return bend_at_ideal_lens(element, at);
    }
    std::array<T, kPhaseTerms> radial;
    for (std::size_t i = 0; i < radial.size(); ++i) {
        radial[i] = T(element.radial[i]);
    }
    return bend_at_phase(T(element.linear), radial, at);
}

}  // namespace lensproof::optics
