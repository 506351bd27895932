#include "engine/optics/edge_diffraction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/base/angle.h"

namespace lensproof::optics::edge_diffraction_test {

using Complex = std::complex<double>;
using std::numbers::pi;

/// F by quadrature along the line on which the integrand falls as a Gaussian does: τ = √x + exp(−iπ/4) t.
Complex by_quadrature(double x) {
    constexpr double kStep = 1.0 / 512;
    const Complex turn = std::polar(1.0, -pi / 4);
    const auto integrand = [&](double t) { return turn * std::exp(-t * t - Complex(0, 2) * std::sqrt(x) * turn * t); };
    Complex sum = 0.0;  // Simpson's rule: its error is some (1/512)⁴ / 180, times derivatives of some hundreds
    for (double t = 0.0; t < 7.0; t += 2 * kStep) {
        sum += kStep / 3 * (integrand(t) + 4.0 * integrand(t + kStep) + integrand(t + 2 * kStep));
    }
    return Complex(0, 2) * std::sqrt(x) * sum;
}

TEST(EdgeDiffraction, TransitionFunctionIsItsIntegral) {
    for (const double x : {1e-6, 0.01, 0.3, 1.0, 3.9, 3.999999, 4.0, 4.1, 5.5, 30.0}) {
        EXPECT_LT(std::abs(transition_function(x) - by_quadrature(x)), 2e-9) << x;
    }
    // On both sides of where one way to compute it takes over from the other; F changes by 0.01 dx there.
    EXPECT_LT(std::abs(transition_function(4.0) - transition_function(std::nextafter(4.0, 0.0))), 1e-13);
    // From 30 digits; a table that is widely copied has 0.5729 + 0.2677i for the first.
    for (const auto& [x, real, imaginary] :
         {std::tuple{0.3, 0.571713, 0.272992}, {1.0, 0.809525, 0.232199}, {5.5, 0.979686, 0.082787}}) {
        EXPECT_NEAR(transition_function(x).real(), real, 5e-7) << x;
        EXPECT_NEAR(transition_function(x).imag(), imaginary, 5e-7) << x;
    }
    // Its expansion for large x, 1 + i/(2x) − 3/(4x²) − 15i/(8x³) + …
    for (const double x : {50.0, 1e3, 1e8}) {
        EXPECT_LT(std::abs(transition_function(x) - Complex(1 - 0.75 / (x * x), 0.5 / x - 1.875 / (x * x * x))),
                  10 / std::pow(x, 4) + 1e-13);
    }
}

/// The field at `diffraction` and `distance` behind a half-plane in a plane wave of amplitude 1: what geometry lets
/// pass and mirrors, and what the edge diffracts.
EdgeCoefficients field(const EdgeAngles& angles, double wavenumber, double distance) {
    const EdgeCoefficients edge = uniform_coefficients(angles, wavenumber, distance);
    const double kr = wavenumber * distance;
    const Complex away = std::polar(1.0 / std::sqrt(distance), -kr);
    const double straight = angles.diffraction - angles.incidence;
    const double mirrored = angles.diffraction + angles.incidence;
    const Complex passed = straight < pi ? std::polar(1.0, kr * std::cos(straight)) : 0.0;
    const Complex reflected = mirrored < pi ? std::polar(1.0, kr * std::cos(mirrored)) : 0.0;
    return {.soft = passed - reflected + away * edge.soft, .hard = passed + reflected + away * edge.hard};
}

// Sommerfeld's solution, which the uniform theory is for a half-plane: kρ = 100, light from 90°, of 20 digits.
TEST(EdgeDiffraction, OfAHalfPlaneIsSommerfelds) {
    constexpr double kDistance = 3.0;
    constexpr double kWavenumber = 100.0 / kDistance;
    for (const auto& [degrees, intensity] : {std::pair{260.0, 1.243695}, {270.0, 0.250398}, {300.0, 0.00632675}}) {
        const EdgeAngles angles{.incidence = radians(90.0), .diffraction = radians(degrees), .cone = radians(90.0)};
        EXPECT_NEAR(field(angles, kWavenumber, kDistance).unpolarised(), intensity, 5e-7 * std::max(1.0, intensity))
            << degrees;
    }
}

// Far behind the edge, v = θ √(2ρ/λ): Fresnel's knife edge (Born & Wolf, §8.7.3). What is mirrored is a part of some θ,
// 2e-4, of the diffracted field, and its square of the mean of both polarisations.
TEST(EdgeDiffraction, NearTheShadowIsTheKnifeEdge) {
    constexpr double kDistance = 1e8;
    for (const auto& [v, intensity] :
         {std::pair{-3.0, 0.00559523963}, {-1.0, 0.0410761242}, {1.0, 1.259228672}, {0.0, 0.25}}) {
        const double off = v * std::sqrt(pi / kDistance);
        const EdgeAngles angles{.incidence = pi / 2, .diffraction = 1.5 * pi - off, .cone = pi / 2};
        EXPECT_NEAR(field(angles, 1.0, kDistance).unpolarised(), intensity, 2e-6) << v;
    }
}

TEST(EdgeDiffraction, TheTheoriesAgreeFarFromTheBoundary) {
    // F is 1 within 1/(2x), x = 2kL cos²(…/2), and both cosines are larger than 0.25 here.
    for (const double incidence : {30.0, 90.0, 140.0}) {
        for (const double cone : {90.0, 40.0}) {
            const EdgeAngles angles{radians(incidence), radians(incidence + 230.0), radians(cone)};
            const EdgeCoefficients keller = keller_coefficients(angles, 1e4);
            const EdgeCoefficients uniform = uniform_coefficients(angles, 1e4, 50.0);
            const double bound = 0.5 / (2e4 * 50.0 * 0.25 * 0.25) * (1 / 0.25 + 1 / 0.25);
            const double scale = 1.0 / (2.0 * std::sqrt(2e4 * pi) * std::sin(angles.cone));
            EXPECT_LT(std::abs(keller.soft - uniform.soft), scale * bound);
            EXPECT_LT(std::abs(keller.hard - uniform.hard), scale * bound);
        }
    }
}

// Light that goes on straight but for a small angle θ: λ / (4π² θ²) of what falls on a mm of edge goes into a radian,
// which is what an opening's far field tends to.
TEST(EdgeDiffraction, SmallAnglesTakeTheSharesOfTheFarField) {
    const double wavelength = 550e-6;
    for (const double theta : {0.01, -0.01, 0.03}) {
        const EdgeAngles angles{.incidence = pi / 2, .diffraction = 1.5 * pi + theta, .cone = pi / 2};
        // The mirrored light's term adds (θ/2)² to 1, and sin(θ/2) is θ/2 within θ²/24.
        EXPECT_NEAR(
            keller_coefficients(angles, 2 * pi / wavelength).unpolarised() * 4 * pi * pi * theta * theta / wavelength,
            1.0, theta * theta);
    }
}

}  // namespace lensproof::optics::edge_diffraction_test
