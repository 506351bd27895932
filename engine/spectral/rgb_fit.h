// engine/spectral/rgb_fit.h — finds the smooth reflectance that has a given colour.
#pragma once
#include <array>
#include <vector>

#include "engine/base/vec.h"

namespace lensproof::spectral {

/// Linear sRGB (the Rec. 709 primaries under D65, by the CIE 1931 observer) of reflectances lit by D65, as sums over
/// wavelengths 5 nm apart, from 360 to 830 nm; white is (1, 1, 1).
struct RgbOfReflectance {
    std::vector<double> abscissa;    // as in sigmoid_spectrum.h
    std::vector<Vec3d> xyz_weight;   // of each; all of them sum to `white`
    Vec3d white;                     // X, Y, Z, with Y = 1
    std::array<Vec3d, 3> primary{};  // X, Y, Z of red, green and blue at 1
};

/// Reads the observer and the illuminant. Throws InputError where the project's own data is damaged.
RgbOfReflectance rgb_of_reflectance();

/// a, b, c of a SigmoidSpectrum.
using Parabola = std::array<double, 3>;

/// X, Y, Z of that reflectance under D65.
Vec3d xyz_of(const RgbOfReflectance& colour, const Parabola& parabola);

/// X, Y, Z of linear sRGB.
Vec3d xyz_of_rgb(const RgbOfReflectance& colour, const Vec3d& rgb);

/// ΔE*ab between that reflectance's colour and `rgb`.
double missed_by(const RgbOfReflectance& colour, const Vec3d& rgb, const Parabola& parabola);

/// The parabola whose reflectance has the colour `rgb`, each in (0, 1), from a first guess: Gauss and Newton's method
/// in CIELAB, damped (Levenberg and Marquardt), until it comes within 1e-6 of ΔE*ab or has stepped 30 times.
Parabola fitted_parabola(const RgbOfReflectance& colour, const Vec3d& rgb, const Parabola& guess);

}  // namespace lensproof::spectral
