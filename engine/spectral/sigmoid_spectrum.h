// engine/spectral/sigmoid_spectrum.h — smooth reflectances of three numbers.
//
// W. Jakob, J. Hanika, "A Low-Dimensional Function Space for Efficient Spectral Upsampling", Eurographics 2019: the
// sigmoid of a parabola over wavelength. It lies in (0, 1) whatever the numbers.
#pragma once
#include <array>
#include <cmath>

namespace lensproof::spectral {

/// The wavelength on the parabola's own scale, on which the visible runs from about −1 to 1.
inline double sigmoid_abscissa(double wavelength_nm) {
    return (wavelength_nm - 555.0) / 175.0;
}

/// ½ + x / (2 √(1 + x²)).
template <class Float>
Float sigmoid(Float x) {
    return Float(0.5) + Float(0.5) * x / std::sqrt(Float(1) + x * x);
}

/// The reflectance sigmoid(a t² + b t + c), t being `sigmoid_abscissa` of the wavelength; {a, b, c}.
struct SigmoidSpectrum {
    std::array<float, 3> coefficient{};

    [[nodiscard]] float at(float abscissa) const {
        return sigmoid((coefficient[0] * abscissa + coefficient[1]) * abscissa + coefficient[2]);
    }
    [[nodiscard]] double operator()(double wavelength_nm) const {
        return at(static_cast<float>(sigmoid_abscissa(wavelength_nm)));
    }
};

}  // namespace lensproof::spectral
