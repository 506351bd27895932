// Zernike polynomials against their published tables and definitions.
#include "engine/analysis/zernike.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "engine/base/input_error.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/perfect_lens.h"

namespace lensproof::analysis::zernike_test {

// Noll (1976), table 1, read row by row, and 16 to 22 by its rule.
TEST(Zernike, NollsTable) {
    constexpr ZernikeMode kTable[] = {{0, 0},  {1, 1}, {1, -1}, {2, 0}, {2, -2}, {2, 2}, {3, -1}, {3, 1},
                                      {3, -3}, {3, 3}, {4, 0},  {4, 2}, {4, -2}, {4, 4}, {4, -4}, {5, 1},
                                      {5, -1}, {5, 3}, {5, -3}, {5, 5}, {5, -5}, {6, 0}};
    int index = 0;
    for (const ZernikeMode mode : kTable) {
        ++index;
        EXPECT_EQ(noll_index(mode), index);
    }
}

// ANSI Z80.28, table of the first fifteen.
TEST(Zernike, AnsiTable) {
    constexpr ZernikeMode kTable[] = {{0, 0}, {1, -1}, {1, 1},  {2, -2}, {2, 0}, {2, 2}, {3, -3}, {3, -1},
                                      {3, 1}, {3, 3},  {4, -4}, {4, -2}, {4, 0}, {4, 2}, {4, 4}};
    int index = 0;
    for (const ZernikeMode mode : kTable) {
        EXPECT_EQ(ansi_index(mode), index);
        EXPECT_EQ(mode_of_ansi(index), mode) << index;
        ++index;
    }
}

// Every index belongs to one mode.
TEST(Zernike, NumberingIsOneToOne) {
    constexpr int kDegree = 40;
    std::set<int> indices;
    for (int n = 0; n <= kDegree; ++n) {
        for (int m = -n; m <= n; m += 2) {
            indices.insert(noll_index({n, m}));
        }
    }
    EXPECT_EQ(static_cast<int>(indices.size()), zernike_count(kDegree));
    EXPECT_EQ(*indices.begin(), 1);
    EXPECT_EQ(*indices.rbegin(), zernike_count(kDegree));
}

// Gauss-Legendre in r² with 13 nodes and 25 azimuths integrate products of degree 24 exactly; so the mean products are
// the unit matrix, to the rounding of 325 terms.
TEST(Zernike, OrthonormalOverTheDisc) {
    constexpr int kDegree = 12;
    const optics::GaussRule rule = optics::gauss_legendre(13);
    const int terms = zernike_count(kDegree);
    std::vector<double> products(static_cast<std::size_t>(terms) * terms, 0.0);
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        for (int i = 0; i < 25; ++i) {
            const double r = std::sqrt(rule.nodes[k]);
            const double azimuth = 2.0 * std::numbers::pi * i / 25;
            const std::vector<double> values = zernike_values(kDegree, {r * std::cos(azimuth), r * std::sin(azimuth)});
            for (int a = 0; a < terms; ++a) {
                for (int b = 0; b < terms; ++b) {
                    products[static_cast<std::size_t>(a) * terms + b] += rule.weights[k] / 25.0 * values[a] * values[b];
                }
            }
        }
    }
    for (int a = 0; a < terms; ++a) {
        for (int b = 0; b < terms; ++b) {
            EXPECT_NEAR(products[static_cast<std::size_t>(a) * terms + b], a == b ? 1.0 : 0.0, 1e-13) << a << " " << b;
        }
    }
}

// R(1) = 1 for every radial polynomial; sums of factorials have lost all digits by degree 50. The recurrence adds one
// rounding per step.
TEST(Zernike, HighDegreesKeepTheirDigits) {
    constexpr int kDegree = 100;
    const std::vector<double> values = zernike_values(kDegree, {1.0, 0.0});
    for (int n = 0; n <= kDegree; ++n) {
        for (int m = n % 2; m <= n; m += 2) {
            const double norm = std::sqrt((m == 0 ? 1.0 : 2.0) * (n + 1.0));
            EXPECT_NEAR(values[static_cast<std::size_t>(noll_index({n, m})) - 1] / norm, 1.0, 1e-13 * (n + 1));
        }
    }
}

std::vector<ZernikeSample> disc_samples(double (*value)(double x, double y), bool half) {
    std::vector<ZernikeSample> samples;
    for (int i = -10; i <= 10; ++i) {
        for (int k = half ? 0 : -10; k <= 10; ++k) {
            const Vec2d at{0.1 * i, 0.1 * k};
            if (at.x * at.x + at.y * at.y <= 1.0) {
                samples.push_back({at, value(at.x, at.y), 1.0 + 0.3 * at.x});
            }
        }
    }
    return samples;
}

// Wherever the samples lie and however they are weighted, a polynomial of the degree is found: r⁴ = (R40 + 3 R20 +
// 2) / 6, r³ sin θ = (R31 + 2 r) sin θ / 3, r² cos 2θ = R22 cos 2θ, over their norms (Noll's table).
TEST(Zernike, SeidelAberrationsHaveTheirCoefficients) {
    constexpr double kRounding = 1e-12;  // the half disc's normal equations have a condition of some 1e3
    for (const bool half : {false, true}) {
        const auto expect_only = [&](const ZernikeFit& found, std::vector<std::pair<int, double>> expected) {
            for (int index = 1; index <= zernike_count(6); ++index) {
                double value = 0.0;
                for (const auto& [noll, coefficient] : expected) {
                    value = noll == index ? coefficient : value;
                }
                EXPECT_NEAR(found.noll(index), value, kRounding) << index << (half ? " half" : " whole");
            }
            EXPECT_LT(found.residual_rms, kRounding);
        };
        const auto spherical = [](double x, double y) { return (x * x + y * y) * (x * x + y * y); };
        expect_only(fit_zernike(disc_samples(spherical, half), 6),
                    {{11, 1.0 / (6.0 * std::sqrt(5.0))}, {4, 0.5 / std::sqrt(3.0)}, {1, 1.0 / 3.0}});
        const auto coma = [](double x, double y) { return (x * x + y * y) * y; };
        expect_only(fit_zernike(disc_samples(coma, half), 6), {{7, 1.0 / (3.0 * std::sqrt(8.0))}, {3, 1.0 / 3.0}});
        const auto astigmatism = [](double x, double y) { return x * x - y * y; };
        const ZernikeFit found = fit_zernike(disc_samples(astigmatism, half), 6);
        expect_only(found, {{6, 1.0 / std::sqrt(6.0)}});
        EXPECT_EQ(found.ansi(5), found.noll(6));
    }
}

TEST(Zernike, RefusesTooFewSamples) {
    const std::vector<ZernikeSample> two(2);
    EXPECT_THROW(fit_zernike(two, 1), InputError);
}

// A perfect lens out of focus by ζ: W = ζ (1 − √(1 − S² r²)) = ζ (S² r²/2 + S⁴ r⁴/8 + …), S the rim's sine, so Noll 4
// and 11 follow with r² = (R20 + 1)/2; the next term is S²/2 of the last.
TEST(Zernike, DefocusedLens) {
    const PerfectLens perfect{
        .beam_radius = 4.0, .stop_distance = PerfectLens{}.telecentric_distance(), .defocus = 0.1};
    const optics::TraceLens<double> traced = optics::at_wavelength<double>(perfect.lens(), spectral::kLineD);
    const optics::FieldBundle bundle{.chief =
                                         optics::ChiefRays(perfect.lens(), spectral::kLineD).at_field(0.0).value()};
    const ReferenceSphere sphere = reference_sphere(traced, bundle).value();
    const optics::RegionOutline outline = beam_outline(traced, bundle);
    const double sine = pupil_radius(traced, bundle, sphere, outline);
    EXPECT_NEAR(sine, 4.0 / 50.0, 0.001);
    const ZernikeFit fit = wavefront_zernike(
        wavefront(traced, spectral::kLineD, bundle, sphere, optics::region_quadrature(outline, 8)), sine, 8);
    const double waves = 0.1 / (spectral::kLineD * 1e-6);
    const double s2 = sine * sine;
    // r⁴ = (R40 + 3 R20 + 2) / 6
    EXPECT_NEAR(fit.noll(4), waves * (s2 / 4.0 + s2 * s2 / 16.0) / std::sqrt(3.0), waves * s2 * s2 * s2 / 16.0);
    EXPECT_NEAR(fit.noll(11), waves * s2 * s2 / 48.0 / std::sqrt(5.0), waves * s2 * s2 * s2 / 16.0);
    EXPECT_LT(fit.residual_rms, 1e-9);
}

}  // namespace lensproof::analysis::zernike_test
