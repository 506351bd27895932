// engine/optics/coating_amplitudes.h — the amplitudes of the waves that a coated surface reflects and lets through.
#pragma once
#include <complex>

#include "engine/optics/coating.h"

namespace lensproof::optics {

/// Amplitudes of the electric field at the surface, the incoming wave's being 1, for waves e^{i(k·x − ωt)}: reflected
/// at the layers' near side, transmitted at their far side. Signs are Fresnel's (Born & Wolf, §1.5.2): p is positive
/// along k × s in each of the three waves, so that r_p = −r_s at normal incidence. A transmitted power is |t|² times
/// the ratio of the two media's n cos θ, for s and p alike.
template <class T>
struct CoatedAmplitudes {
    std::complex<T> r_s;
    std::complex<T> r_p;
    std::complex<T> t_s;
    std::complex<T> t_p;
};

/// The product of finite numbers: std::complex's own looks for infinities, which takes longer than the product.
template <class T>
constexpr std::complex<T> times(const std::complex<T>& a, const std::complex<T>& b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// Amplitudes in the place of powers. A stated reflectance gives their moduli, the bare surface their phases. A
/// mirror's are those of a perfect conductor: in space that is unfolded at it both polarisations go on alike.
template <class T, class Layers = TraceLayers<T>>
constexpr CoatedAmplitudes<T> coating_amplitudes(const TraceCoating<T, Layers>& coating, const T& n1, const T& n2,
                                                 const T& cos_incidence, bool from_scene_side) {
    using std::sqrt;
    if (coating.is_mirror) {
        const std::complex<T> passing(sqrt(coating.reflectance.value_or(T(1))));
        return {.r_s = {}, .r_p = {}, .t_s = passing, .t_p = passing};
    }
    const PolarisedFields<T> fields = stack_fields(coating, n1, n2, cos_incidence, from_scene_side);
    const T from_magnetic = from_scene_side ? n1 / n2 : n2 / n1;
    const auto standard = [](const Complex<T>& z) { return std::complex<T>(z.real, z.imag); };
    CoatedAmplitudes<T> amplitudes{.r_s = standard(fields.s.reflected()),
                                   .r_p = standard(fields.p.reflected()),
                                   .t_s = standard(fields.s.transmitted()),
                                   .t_p = standard(from_magnetic * fields.p.transmitted())};
    if (coating.reflectance && !is_beyond_critical(n1, n2, cos_incidence, from_scene_side)) {
        const auto scale_to = [](std::complex<T>& amplitude, const T& power, const T& stated) {
            amplitude = power > T(0) ? amplitude * sqrt(stated / power) : std::complex<T>(sqrt(stated));
        };
        const CoatedPowers<T> s = fields.s.powers();
        const CoatedPowers<T> p = fields.p.powers();
        scale_to(amplitudes.r_s, s.reflected, *coating.reflectance);
        scale_to(amplitudes.r_p, p.reflected, *coating.reflectance);
        scale_to(amplitudes.t_s, s.transmitted, T(1) - *coating.reflectance);
        scale_to(amplitudes.t_p, p.transmitted, T(1) - *coating.reflectance);
    }
    return amplitudes;
}

}  // namespace lensproof::optics
