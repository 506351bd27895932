// engine/optics/coating.h — what a coated surface reflects and lets through: thin films by their characteristic
// matrices, each polarisation by itself.
#pragma once
#include <cmath>
#include <optional>
#include <vector>

#include "engine/base/complex.h"
#include "engine/base/elementary.h"

namespace lensproof::optics {

/// A layer at one wavelength.
template <class T>
struct TraceLayer {
    T index;              // n of the complex index n + iκ
    T thickness;          // in vacuum wavelengths
    T extinction = T(0);  // κ, 0 or above: a wave fades as e^{−2πκ z/λ}
};

template <class T>
using TraceLayers = std::vector<TraceLayer<T>>;

/// A coating at one wavelength: layers from the scene's side to the sensor's, or a stated reflectance in their place,
/// which then holds at every angle from which light passes. Of a mirror in the sequence of surfaces, what it reflects
/// is what goes on through the lens, so that counts as transmitted.
///
/// Layers: a vector, or a span of someone else's.
template <class T, class Layers = TraceLayers<T>>
struct TraceCoating {
    using Layer = TraceLayer<T>;

    Layers layers;
    std::optional<T> reflectance;
    bool is_mirror = false;  // of the stated reflectance, or of 1

    [[nodiscard]] constexpr bool is_bare() const { return layers.empty() && !reflectance && !is_mirror; }
    [[nodiscard]] constexpr bool is_stated() const { return is_mirror || reflectance.has_value(); }
};

/// A coated surface's reflectance and transmittance of power; the layers keep the rest.
template <class T>
struct CoatedPowers {
    T reflected;
    T transmitted;

    [[nodiscard]] constexpr T absorbed() const { return T(1) - reflected - transmitted; }
};

/// Both polarisations' powers. Their mean is what becomes of unpolarised light.
template <class T>
struct PolarisedPowers {
    CoatedPowers<T> s;
    CoatedPowers<T> p;

    [[nodiscard]] constexpr CoatedPowers<T> unpolarised() const {
        return {(s.reflected + p.reflected) / T(2), (s.transmitted + p.transmitted) / T(2)};
    }
};

/// A layer's wave of longitudinal wavenumber q (in units of the vacuum's, Im q ≥ 0) over its thickness: cos φ and
/// sin φ / q, φ = 2π q · thickness, both divided by e^{Im φ} (which is 1 / `decay`), so that they stay finite in
/// layers that are thick and let little through. Both are even in q: where a layer is at its critical angle nothing is
/// lost.
template <class T>
struct LayerWave {
    Complex<T> cosine;
    Complex<T> sine_by_q;
    T decay;
};

template <class T>
constexpr LayerWave<T> layer_wave(const Complex<T>& q_squared, const T& phase_by_q) {
    using std::exp;
    using std::expm1;
    using std::sqrt;
    const T real = q_squared.real;
    if (q_squared.imag == T(0)) {
        const T q = real < T(0) ? sqrt(-real) : sqrt(real);
        const T phase = phase_by_q * q;
        if (phase == T(0)) {
            return {{T(1)}, {phase_by_q}, T(1)};
        }
        if (real > T(0)) {
            const auto [cosine, sine] = cos_sin(phase);
            return {{cosine}, {sine / q}, T(1)};
        }
        const T fall = expm1(T(-2) * phase);  // cosh φ = (1 + e^{−2φ}) e^φ / 2, and sinh φ likewise
        return {{T(1) + fall / T(2)}, {-fall / (T(2) * q)}, exp(-phase)};
    }
    const Complex<T> q = sqrt_of_upper(q_squared);
    const T turn = phase_by_q * q.real;
    const T fading = phase_by_q * q.imag;
    const T fall = expm1(T(-2) * fading);
    const T cosh = T(1) + fall / T(2);
    const T sinh = -fall / T(2);
    const auto [cos_turn, sin_turn] = cos_sin(turn);
    const Complex<T> sine{sin_turn * cosh, cos_turn * sinh};
    return {{cos_turn * cosh, -sin_turn * sinh}, sine / q, exp(-fading)};
}

/// One polarisation's tangential fields on the near side of the layers, up to the factor `scale`, and the admittances
/// of the two media: η = n cos θ for s, with the electric field first, and cos θ / n for p, with the magnetic field
/// first. So neither is infinite at grazing incidence.
template <class T>
struct StackFields {
    Complex<T> first;
    Complex<T> second;
    T scale;  // first and second are the fields times this, where the transmitted wave has amplitude 1
    T eta_near;
    Complex<T> eta_far;

    [[nodiscard]] constexpr Complex<T> incoming() const { return eta_near * first + second; }  // times 2 η_near
    [[nodiscard]] constexpr Complex<T> outgoing() const { return eta_near * first - second; }
    [[nodiscard]] constexpr Complex<T> reflected() const { return outgoing() / incoming(); }
    [[nodiscard]] constexpr Complex<T> transmitted() const { return Complex<T>{T(2) * eta_near * scale} / incoming(); }
    /// Those of power, of which the incoming wave has |incoming|².
    [[nodiscard]] constexpr T incoming_power() const { return norm(incoming()); }
    [[nodiscard]] constexpr T outgoing_power() const { return norm(outgoing()); }
    [[nodiscard]] constexpr T transmitted_power() const { return T(4) * eta_near * eta_far.real * scale * scale; }
    [[nodiscard]] constexpr CoatedPowers<T> powers() const {
        return {.reflected = outgoing_power() / incoming_power(),
                .transmitted = transmitted_power() / incoming_power()};
    }
};

template <class T>
struct PolarisedFields {
    StackFields<T> s;
    StackFields<T> p;

    /// Of unpolarised light: the mean of both powers, with one division.
    [[nodiscard]] constexpr T reflectance() const { return mean(s.outgoing_power(), p.outgoing_power()); }
    [[nodiscard]] constexpr T transmittance() const { return mean(s.transmitted_power(), p.transmitted_power()); }

  private:
    [[nodiscard]] constexpr T mean(const T& of_s, const T& of_p) const {
        const T in_s = s.incoming_power();
        const T in_p = p.incoming_power();
        return (of_s * in_p + of_p * in_s) / (T(2) * (in_s * in_p));
    }
};

/// The media on both sides of a coating as light comes to it, and 1 over the squares of their indices.
template <class T>
struct CoatedMedia {
    T near;
    T far;
    T per_squared_near;
    T per_squared_far;
};

/// Behind all layers; longitudinal wavenumbers in the two media.
template <class T>
constexpr PolarisedFields<T> fields_behind(const CoatedMedia<T>& media, const T& q_near, const Complex<T>& q_far) {
    PolarisedFields<T> fields{
        .s = {.first = {T(1)}, .second = q_far, .scale = T(1), .eta_near = q_near, .eta_far = q_far},
        .p = {
            .first = {T(1)}, .second = {}, .scale = T(1), .eta_near = q_near * media.per_squared_near, .eta_far = {}}};
    fields.p.eta_far = media.per_squared_far * q_far;
    fields.p.second = fields.p.eta_far;
    return fields;
}

/// From a layer's far side to its near one, but for its decay. `Number`: T where the layer's numbers are real, as
/// nearly all are; then half of the products with complex ones would be with 0.
///
/// A layer's matrix is [cos φ, −i sin φ / η; −i η sin φ, cos φ] on (first, second), applied to (1, η_far) from the far
/// side on (Abelès 1950; Macleod, Thin-Film Optical Filters, 4th ed., §2.4, with κ and i of the other sign).
template <class T, class Number>
constexpr void cross_layer(PolarisedFields<T>& fields, const Number& cosine, const Number& sine_by_q,
                           const Number& q_squared, const Number& n_squared, const Number& per_n_squared) {
    const auto cross = [&](StackFields<T>& of, const Number& by_eta, const Number& with_eta) {
        const Complex<T> to_first = by_eta * of.second;
        const Complex<T> to_second = with_eta * of.first;
        of.first = cosine * of.first + Complex<T>{to_first.imag, -to_first.real};
        of.second = cosine * of.second + Complex<T>{to_second.imag, -to_second.real};
    };
    const Number sine_times_q = sine_by_q * q_squared;
    cross(fields.s, sine_by_q, sine_times_q);
    cross(fields.p, sine_by_q * n_squared, sine_times_q * per_n_squared);
}

/// Beyond this magnitude what fields have grown by is kept apart: their fourth powers are far from a float's largest.
inline constexpr double kLargeFields = 1e4;

template <class T>
constexpr T magnitude(const StackFields<T>& of) {
    using std::abs;
    return abs(of.first.real) + abs(of.first.imag) + abs(of.second.real) + abs(of.second.imag);
}

/// The fields on the side that light comes from, at an angle of cosine `cos_incidence` there (above 0). `n1` is the
/// medium on the scene's side, `n2` that on the sensor's.
///
/// Going back, the wave that fades in the layers grows and the others' rounding errors fade; what it grows by is kept
/// apart.
template <class T, class Layers = TraceLayers<T>>
constexpr PolarisedFields<T> stack_fields(const TraceCoating<T, Layers>& coating, const T& n1, const T& n2,
                                          const T& cos_incidence, bool from_scene_side) {
    using std::abs;
    using std::acos;
    using std::sqrt;
    using Complex = lensproof::Complex<T>;
    const T near = abs(from_scene_side ? n1 : n2);  // behind a mirror both are negative
    const T far = abs(from_scene_side ? n2 : n1);
    const T q_near = near * cos_incidence;
    const T far_squared = (far - near) * (far + near) + q_near * q_near;
    const Complex q_far = far_squared < T(0) ? Complex{T(0), sqrt(-far_squared)} : Complex{sqrt(far_squared)};
    PolarisedFields<T> fields = fields_behind<T>(
        {.near = near, .far = far, .per_squared_near = T(1) / (near * near), .per_squared_far = T(1) / (far * far)},
        q_near, q_far);
    const T two_pi = T(2) * acos(T(-1));  // in every number type
    const std::size_t count = coating.layers.size();
    for (std::size_t i = 0; i < count; ++i) {
        const TraceLayer<T>& layer = coating.layers[from_scene_side ? count - 1 - i : i];
        const T& n = layer.index;
        const T& kappa = layer.extinction;
        const Complex n_squared{(n - kappa) * (n + kappa), T(2) * n * kappa};
        const Complex q_squared{(n - near) * (n + near) - kappa * kappa + q_near * q_near, n_squared.imag};
        const LayerWave<T> wave = layer_wave(q_squared, two_pi * layer.thickness);
        if (q_squared.imag == T(0)) {
            cross_layer(fields, wave.cosine.real, wave.sine_by_q.real, q_squared.real, n_squared.real,
                        T(1) / n_squared.real);
        } else {
            cross_layer(fields, wave.cosine, wave.sine_by_q, q_squared, n_squared, Complex{T(1)} / n_squared);
        }
        for (StackFields<T>* of : {&fields.s, &fields.p}) {
            of->scale = of->scale * wave.decay;
            if (const T large(kLargeFields);
                magnitude(*of) > large) {  // a mirror's fields grow with each of its layers
                of->first = of->first / large;
                of->second = of->second / large;
                of->scale = of->scale / large;
            }
        }
    }
    return fields;
}

/// A layer that absorbs nothing, at one wavelength.
template <class T>
struct alignas(4 * sizeof(T)) ClearLayer {
    T index;
    T phase_by_q;  // 2π · its thickness in vacuum wavelengths
    T squared;     // index², and 1 over it
    T per_squared;
};

template <class T>
ClearLayer<T> clear_layer(const TraceLayer<T>& layer) {
    const T squared = layer.index * layer.index;
    return {.index = layer.index,
            .phase_by_q = T(2) * std::acos(T(-1)) * layer.thickness,
            .squared = squared,
            .per_squared = T(1) / squared};
}

/// The same fields as `stack_fields` has, to the bit, of a packet's lanes in which no wave fades and none is reflected
/// totally: `holds` in these, in the others nothing is said.
template <Packet T>
struct ClearFields {
    PolarisedFields<T> fields;
    MaskOf<T> holds;
};

/// Of layers that absorb nothing: `layer_at(i)` is the i-th from the far side, a ClearLayer.
template <Packet T, class LayerAt>
constexpr ClearFields<T> clear_coating_fields(int count, const LayerAt& layer_at, const CoatedMedia<T>& media,
                                              const T& cos_incidence) {
    using Number = typename LaneOf<T>::Number;
    const T zero(Number(0));
    const T near = abs(media.near);
    const T far = abs(media.far);
    const T q_near = near * cos_incidence;
    const T far_squared = (far - near) * (far + near) + q_near * q_near;
    MaskOf<T> holds = far_squared >= zero;
    PolarisedFields<T> fields = fields_behind(media, q_near, Complex<T>{sqrt(far_squared), zero});
    for (int i = 0; i < count; ++i) {
        const ClearLayer<T> layer = layer_at(i);
        const T& n = layer.index;
        const T q_squared = (n - near) * (n + near) + q_near * q_near;
        const T q = sqrt(q_squared);
        const T phase = layer.phase_by_q * q;
        holds = holds && q_squared > zero && phase > zero && phase <= T(kMostTurned<Number>);
        const auto [cosine, sine] = cos_sin_within(phase);
        cross_layer(fields, cosine, sine / q, q_squared, layer.squared, layer.per_squared);
        for (const StackFields<T>* of : {&fields.s, &fields.p}) {
            holds = holds && magnitude(*of) <= T(Number(kLargeFields));
        }
    }
    return {.fields = fields, .holds = holds};
}

/// Whether light from that side gets through at all, or is reflected totally by the medium behind the coating.
template <class T>
constexpr auto is_beyond_critical(const T& n1, const T& n2, const T& cos_incidence, bool from_scene_side) {
    const T& near = from_scene_side ? n1 : n2;
    const T& far = from_scene_side ? n2 : n1;
    return (far - near) * (far + near) + near * near * cos_incidence * cos_incidence <= T(0);
}

/// Of a coating without layers.
template <class T, class Layers = TraceLayers<T>>
constexpr CoatedPowers<T> stated_powers(const TraceCoating<T, Layers>& coating, const T& n1, const T& n2,
                                        const T& cos_incidence, bool from_scene_side) {
    if (coating.is_mirror) {
        return {.reflected = T(0), .transmitted = coating.reflectance.value_or(T(1))};
    }
    const T stated = is_beyond_critical(n1, n2, cos_incidence, from_scene_side) ? T(1) : *coating.reflectance;
    return {.reflected = stated, .transmitted = T(1) - stated};
}

/// Reflectance and transmittance for light that meets a surface between `n1` on the scene's side and `n2` on the
/// sensor's, coming from either at an angle of cosine `cos_incidence` (in its own medium, above 0). Beyond the critical
/// angle nothing is transmitted, and what layers without absorption reflect is 1. Without layers these are Fresnel's.
template <class T, class Layers = TraceLayers<T>>
constexpr PolarisedPowers<T> coating_powers(const TraceCoating<T, Layers>& coating, const T& n1, const T& n2,
                                            const T& cos_incidence, bool from_scene_side) {
    if (coating.is_stated()) {
        const CoatedPowers<T> powers = stated_powers(coating, n1, n2, cos_incidence, from_scene_side);
        return {powers, powers};
    }
    const PolarisedFields<T> fields = stack_fields(coating, n1, n2, cos_incidence, from_scene_side);
    return {fields.s.powers(), fields.p.powers()};
}

/// Of unpolarised light.
template <class T, class Layers = TraceLayers<T>>
constexpr T coating_transmittance(const TraceCoating<T, Layers>& coating, const T& n1, const T& n2,
                                  const T& cos_incidence, bool from_scene_side) {
    return coating.is_stated() ? stated_powers(coating, n1, n2, cos_incidence, from_scene_side).transmitted
                               : stack_fields(coating, n1, n2, cos_incidence, from_scene_side).transmittance();
}

template <class T, class Layers = TraceLayers<T>>
constexpr T coating_reflectance(const TraceCoating<T, Layers>& coating, const T& n1, const T& n2,
                                const T& cos_incidence, bool from_scene_side) {
    return coating.is_stated() ? stated_powers(coating, n1, n2, cos_incidence, from_scene_side).reflected
                               : stack_fields(coating, n1, n2, cos_incidence, from_scene_side).reflectance();
}

}  // namespace lensproof::optics
