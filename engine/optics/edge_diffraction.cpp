#include "engine/optics/edge_diffraction.h"

#include <cmath>
#include <numbers>

namespace lensproof::optics {

namespace {

using std::numbers::pi;

/// exp(z²) erfc(z) on the ray arg z = π/4. Below |z| = 2 by the series of erf (Abramowitz and Stegun, 7.1.6, whose
/// terms do not cancel there), beyond by the continued fraction (7.1.14).
std::complex<double> scaled_erfc(double modulus) {
    const std::complex<double> z = std::polar(modulus, pi / 4);
    const std::complex<double> z2(0.0, modulus * modulus);
    if (modulus < 2.0) {
        std::complex<double> term = z;
        std::complex<double> sum = z;
        for (int n = 1; std::abs(term) > 1e-17 * std::abs(sum); ++n) {
            term *= 2.0 * z2 / (2.0 * n + 1.0);
            sum += term;
        }
        return std::exp(z2) - 2.0 / std::sqrt(pi) * sum;
    }
    // 1/√π · 1/(z + (1/2)/(z + 1/(z + (3/2)/(z + …)))), from far enough inside; at |z| = 2 that is 120 terms.
    std::complex<double> rest = z;
    for (int n = 150; n > 0; --n) {
        rest = z + 0.5 * n / rest;
    }
    return 1.0 / (std::sqrt(pi) * rest);
}

/// Both theories have the same two terms, of the light that goes straight on and of that which is mirrored.
template <class Term>
EdgeCoefficients coefficients(const EdgeAngles& angles, double wavenumber, const Term& term) {
    const std::complex<double> factor =
        -std::polar(1.0, -pi / 4) / (2.0 * std::sqrt(2.0 * pi * wavenumber) * std::sin(angles.cone));
    const std::complex<double> straight = term(std::cos((angles.diffraction - angles.incidence) / 2.0));
    const std::complex<double> mirrored = term(std::cos((angles.diffraction + angles.incidence) / 2.0));
    return {.soft = factor * (straight - mirrored), .hard = factor * (straight + mirrored)};
}

}  // namespace

std::complex<double> transition_function(double x) {
    // The integral is √π/2 · exp(−iπ/4) erfc(exp(iπ/4) √x).
    return std::polar(std::sqrt(pi * x), pi / 4) * scaled_erfc(std::sqrt(x));
}

EdgeCoefficients keller_coefficients(const EdgeAngles& angles, double wavenumber) {
    return coefficients(angles, wavenumber, [](double cosine) { return std::complex<double>(1.0 / cosine); });
}

EdgeCoefficients uniform_coefficients(const EdgeAngles& angles, double wavenumber, double distance) {
    // F(2kL c²) / c without the quotient: F is √x times what does not vanish.
    const double root = std::sqrt(2.0 * wavenumber * distance);
    return coefficients(angles, wavenumber, [&](double cosine) {
        return std::copysign(root, cosine) * std::polar(std::sqrt(pi), pi / 4) * scaled_erfc(root * std::abs(cosine));
    });
}

}  // namespace lensproof::optics
