// engine/optics/reflect.h — the law of reflection at one surface, and how much light it sends back.
#pragma once
#include "engine/optics/trace.h"

namespace lensproof::optics {

/// The direction after a mirror whose unit normal is turned along the ray: d − 2 cos i n.
template <class T>
constexpr Vec3<T> reflect(const Vec3<T>& direction, const Vec3<T>& normal, const T& cos_incidence) {
    return direction - (T(2) * cos_incidence) * normal;
}

/// The reflectance of an uncoated surface for unpolarised light (Fresnel; Born & Wolf, Principles of Optics, 7th ed.,
/// §1.5.2, eqs. 21a, 21b). By itself and not as 1 − T, so that a cemented surface's keeps its digits; between equal
/// indices it is exactly 0.
template <class T>
constexpr T fresnel_reflectance(const T& index_before, const T& index_after, const T& cos_incidence,
                                const T& cos_refraction) {
    const auto amplitude = [](const T& a, const T& b) { return (a - b) / (a + b); };
    const T s = amplitude(index_before * cos_incidence, index_after * cos_refraction);
    const T p = amplitude(index_after * cos_incidence, index_before * cos_refraction);
    return (s * s + p * p) / T(2);
}

/// What a surface reflects of unpolarised light that runs forward through the lens or back; `special` is null where it
/// has nothing beyond its sphere. Beyond the critical angle a bare surface reflects all.
template <class T, class Special>
constexpr T surface_reflectance(const TraceSurface<T>& surface, const Special* special, bool forward,
                                const T& cos_incidence, const Refraction<T>& bent) {
    if (special != nullptr && !special->coating.is_bare()) {
        return coating_reflectance(special->coating, surface.index_before, surface.index_after, cos_incidence, forward);
    }
    if (!bent.transmitted) {
        return T(1);
    }
    return forward ? fresnel_reflectance(surface.index_before, surface.index_after, cos_incidence, bent.cos_refraction)
                   : fresnel_reflectance(surface.index_after, surface.index_before, cos_incidence, bent.cos_refraction);
}

}  // namespace lensproof::optics
