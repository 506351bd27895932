// tests/experiments/studies/tradeoff/point_sums_test.cpp — the modulation that rays leave, against closed forms.
#include "experiments/studies/tradeoff/point_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lensproof::studies::point_sums_test {

// An even disc of radius a leaves 2 J₁(x)/x of lines of frequency f, x = 2πaf. Rays at the middles of n rings of one
// area are the midpoint rule for ∫ J₀(x √u) du, whose second derivative is at most x⁴/32: they err by x⁴/(768 n²).
TEST(Modulation, OfADiscIsItsBesselFunction) {
    constexpr int kRings = 100;
    constexpr int kSpokes = 64;
    for (const double x : {0.5, 2.0, 3.8, 6.0}) {
        Modulation disc;
        for (int ring = 0; ring < kRings; ++ring) {
            const double radius = x / (2.0 * std::numbers::pi) * std::sqrt((ring + 0.5) / kRings);
            for (int spoke = 0; spoke < kSpokes; ++spoke) {
                const double angle = 2.0 * std::numbers::pi * spoke / kSpokes;
                disc.add(0.7, {3.0 + radius * std::cos(angle), radius * std::sin(angle)});
            }
        }
        const double expected = std::abs(2.0 * std::cyl_bessel_j(1.0, x) / x);
        const double tolerance = std::pow(x, 4) / (768.0 * kRings * kRings) + 1e-12;
        EXPECT_NEAR(disc.mtf(0), expected, tolerance);
        EXPECT_NEAR(disc.mtf(1), expected, tolerance);
    }
}

// A Gaussian of σ leaves exp(−2π²σ²f²), in each direction by itself. Sums over a fine grid are exact for it, up to what
// lies beyond 8 σ.
TEST(Modulation, OfAGaussianIsOneInEachDirection) {
    constexpr double kAlong = 0.2;  // σ times the frequency
    constexpr double kAcross = 0.05;
    Modulation spot;
    for (int i = -80; i <= 80; ++i) {
        for (int j = -80; j <= 80; ++j) {
            const Vec2d sigmas{0.1 * i, 0.1 * j};
            spot.add(std::exp(-0.5 * (sigmas.x * sigmas.x + sigmas.y * sigmas.y)),
                     {kAlong * sigmas.x, kAcross * sigmas.y});
        }
    }
    const auto expected = [](double sigma) { return std::exp(-2.0 * std::pow(std::numbers::pi * sigma, 2)); };
    EXPECT_NEAR(spot.mtf(0), expected(kAlong), 1e-12);
    EXPECT_NEAR(spot.mtf(1), expected(kAcross), 1e-12);
}

}  // namespace lensproof::studies::point_sums_test
