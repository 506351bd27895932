// engine/optics/coating.h — how much light passes a coated surface, by thin-film transfer matrices.
#pragma once
#include <cmath>
#include <complex>
#include <optional>
#include <vector>

namespace lensproof::optics {

/// A coating at one wavelength: layers without absorption from the scene's side to the sensor's, or a stated
/// reflectance in their place, which then holds at every angle.
template <class T>
struct TraceCoating {
    struct Layer {
        T index;
        T thickness;  // in vacuum wavelengths
    };
    std::vector<Layer> layers;
    std::optional<T> reflectance;

    [[nodiscard]] bool is_bare() const { return layers.empty() && !reflectance; }
};

/// The transmittance for unpolarised light from a medium of index `n1` at the angle of cosine `cos1` into one of `n2`
/// at `cos2`; n1 lies on the scene's side, wherever the light comes from (the transmittance is the same).
///
/// Each layer's characteristic matrix is [cos δ, i sin δ / η; i η sin δ, cos δ] with δ = 2π n d cos θ / λ and the
/// tilted admittance η = n cos θ (s) or n / cos θ (p); with [B; C] their product on [1; η₂], T = 4 η₁ η₂ / |η₁ B + C|²
/// (Macleod, Thin-Film Optical Filters, 4th ed., §2.4; Abelès 1950). Within a layer beyond its critical angle cos θ is
/// imaginary and the same formulas hold.
template <class T>
T coating_transmittance(const TraceCoating<T>& coating, const T& n1, const T& n2, const T& cos1, const T& cos2) {
    if (coating.reflectance) {
        return T(1) - *coating.reflectance;
    }
    using Complex = std::complex<T>;
    const T sine = n1 * n1 * (T(1) - cos1 * cos1);  // (n sin θ)², the same in every layer
    using std::acos;
    const T pi = acos(T(-1));  // in every number type
    T sum = T(0);
    for (const bool s_polarised : {true, false}) {
        const auto admittance = [&](const Complex& n, const Complex& cosine) {
            return s_polarised ? n * cosine : n / cosine;
        };
        Complex b(T(1));
        Complex c = admittance(n2, cos2);
        const T eta1 = admittance(n1, cos1).real();
        const T eta2 = c.real();
        for (auto layer = coating.layers.rbegin(); layer != coating.layers.rend(); ++layer) {
            const Complex cosine = sqrt(Complex(T(1) - sine / (layer->index * layer->index)));
            const Complex eta = admittance(layer->index, cosine);
            const Complex phase = T(2) * pi * layer->index * layer->thickness * cosine;
            const Complex i_sine = Complex(T(0), T(1)) * std::sin(phase);
            const Complex cos_phase = std::cos(phase);
            const Complex next_b = cos_phase * b + i_sine / eta * c;
            c = i_sine * eta * b + cos_phase * c;
            b = next_b;
        }
        sum += T(4) * eta1 * eta2 / std::norm(eta1 * b + c);
    }
    return sum / T(2);
}

}  // namespace lensproof::optics
