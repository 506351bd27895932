// engine/optics/refract.h — Snell's law and Fresnel's equations at one surface.
#pragma once
#include <cmath>

#include "engine/base/select.h"
#include "engine/base/vec.h"

namespace lensproof::optics {

/// The outcome of `refract`. Where `transmitted` is false (total internal reflection) the numbers are finite and
/// meaningless.
template <class T>
struct Refraction {
    Vec3<T> direction;
    T cos_refraction;
    decltype(T() < T()) transmitted;
};

/// The cosine after a surface and whether there is one.
template <class T>
struct CosRefraction {
    T cosine;
    decltype(T() < T()) transmitted;
};

template <class T>
constexpr CosRefraction<T> cos_refraction(const T& cos_incidence, const T& sin2_incidence, const T& index_ratio) {
    using std::sqrt;
    const T squared = cos_incidence * cos_incidence + (T(1) - index_ratio) * (T(1) + index_ratio) * sin2_incidence;
    const auto transmitted = squared > T(0);
    return {.cosine = sqrt(select(transmitted, squared, T(1))), .transmitted = transmitted};
}

/// The direction after a surface, by Snell's law in vector form: d' = μ d + (cos i' − μ cos i) n with μ = n₁/n₂
/// (Welford, Aberrations of Optical Systems, §4.3). `normal` has unit length and points along the ray (d·n = cos i >
/// 0).
///
/// cos² i' = 1 − μ² sin² i is formed as cos² i + (1 − μ²) sin² i, which is exact for μ = 1.
template <class T>
constexpr Refraction<T> refract(const Vec3<T>& direction, const Vec3<T>& normal, const T& cos_incidence,
                                const T& sin2_incidence, const T& index_ratio) {
    const auto [cosine, transmitted] = cos_refraction(cos_incidence, sin2_incidence, index_ratio);
    return {.direction = index_ratio * direction + (cosine - index_ratio * cos_incidence) * normal,
            .cos_refraction = cosine,
            .transmitted = transmitted};
}

/// The normal at a point of the sphere of `intersect`.
template <class T>
constexpr Vec3<T> normal_of_sphere(const Vec3<T>& point, const T& c, const T& heading) {
    return heading * Vec3<T>{-c * point.x, -c * point.y, T(1) - c * point.z};
}

/// The same at a point of that sphere, whose normal is heading · (−c x, −c y, 1 − c z): in fewer steps, for the inner
/// loop.
template <class T>
constexpr Refraction<T> refract_at_sphere(const Vec3<T>& direction, const Vec3<T>& point, const T& c, const T& heading,
                                          const T& cos_incidence, const T& sin2_incidence, const T& index_ratio) {
    const auto [cosine, transmitted] = cos_refraction(cos_incidence, sin2_incidence, index_ratio);
    const T along_z = heading * (cosine - index_ratio * cos_incidence);
    const T towards_centre = -c * along_z;
    return {.direction = {index_ratio * direction.x + towards_centre * point.x,
                          index_ratio * direction.y + towards_centre * point.y,
                          index_ratio * direction.z + (along_z + towards_centre * point.z)},
            .cos_refraction = cosine,
            .transmitted = transmitted};
}

/// The same where sin² i is not known: the square of d − cos i n, which keeps the digits of small angles.
template <class T>
constexpr Refraction<T> refract(const Vec3<T>& direction, const Vec3<T>& normal, const T& cos_incidence,
                                const T& index_ratio) {
    const Vec3<T> across = direction - cos_incidence * normal;
    return refract(direction, normal, cos_incidence, dot(across, across), index_ratio);
}

/// A part of a whole: the product of many takes one division.
template <class T>
struct Fraction {
    T part = T(1);
    T whole = T(1);

    [[nodiscard]] constexpr T value() const { return part / whole; }
};

/// The transmittance of an uncoated surface for unpolarised light (Fresnel; Born & Wolf, Principles of Optics, 7th ed.,
/// §1.5.2, eqs. 21a, 21b), by the ratio of the indices before and after.
///
/// Of either polarisation T = 4 a b / (a + b)², with a and b the two media's n cos i (s), or each index with the other
/// cosine (p); the product a b is the same for both, and so their mean is
///
///     T = 2 a b ((a_s + b_s)² + (a_p + b_p)²) / ((a_s + b_s)² (a_p + b_p)²).
///
/// Near grazing, where little passes, it keeps the digits that 1 − R loses. Between equal indices it is exactly 1.
template <class T>
constexpr Fraction<T> fresnel_transmittance(const T& index_ratio, const T& cos_incidence, const T& cos_refraction) {
    const T a = index_ratio * cos_incidence;
    const T s = a + cos_refraction;
    const T p = cos_incidence + index_ratio * cos_refraction;
    const T s2 = s * s;
    const T p2 = p * p;
    const auto is_same = index_ratio == T(1);
    return {.part = select(is_same, T(1), (a + a) * cos_refraction * (s2 + p2)),
            .whole = select(is_same, T(1), s2 * p2)};
}

}  // namespace lensproof::optics
