// Rough and diffuse surfaces: what they draw is what they say, and light can go back the way it came.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/quadrature/gauss.hpp>

#include "tests/engine/scene/bsdf/bsdf_cases.h"

namespace lensproof::bsdf_sampling_test {

using std::numbers::pi;

const scene::BsdfTables& tables() {
    static const scene::BsdfTables all;
    return all;
}

constexpr double kViews[] = {0.95, 0.6, 0.15, -0.9, -0.4};

// A sample weighs f |cos| / pdf, and its pdf is what `pdf` says: to the rounding of floats, of which each
// value takes some ten.
TEST(Bsdf, SamplesWeighTheirValueOverTheirDensity) {
    scene::Uniform uniform(1);
    for (const auto& [name, bsdf] : scene::broad_cases(tables())) {
        for (int i = 0; i < 2000; ++i) {
            const Vec3d wo = scene::random_direction(uniform);
            const auto drawn = scene::sample(bsdf, wo, scene::bsdf_numbers(uniform(), uniform(), uniform()),
                                             scene::Transport::radiance);
            if (!drawn || drawn->is_delta) {
                continue;
            }
            ASSERT_GT(drawn->pdf, 0.0) << name;
            EXPECT_NEAR(length(drawn->wi), 1.0, 1e-12) << name;
            const double again = scene::pdf(bsdf, wo, drawn->wi, scene::Transport::radiance);
            // The facet is found again from the directions, to 1e-15 of its slope over α² and their sum's length.
            EXPECT_NEAR(drawn->pdf, again, 1e-9 * again) << name;
            const spectral::SpectralSample value = scene::evaluate(bsdf, wo, drawn->wi, scene::Transport::radiance);
            for (std::size_t c = 0; c < spectral::kWavelengthsPerPath; ++c) {
                EXPECT_NEAR(drawn->weight[c], value[c] / again, 2e-6 * drawn->weight[c]) << name;
            }
        }
    }
}

// Helmholtz: light that can go one way can go the other. For reflection f(wo, wi) = f(wi, wo); for refraction n⁻² f is
// symmetric, n being the index on wo's side, and importance's f is radiance's with the directions exchanged (Veach
// 1997, §5.2). Single rounding to float of each, and of the index.
TEST(Bsdf, IsReciprocal) {
    scene::Uniform uniform(2);
    for (const auto& [name, bsdf] : scene::broad_cases(tables())) {
        const auto* glass = std::get_if<scene::DielectricBsdf>(&bsdf);
        for (int i = 0; i < 2000; ++i) {
            const Vec3d wo = scene::random_direction(uniform);
            const Vec3d wi = scene::random_direction(uniform);
            const spectral::SpectralSample there = scene::evaluate(bsdf, wo, wi, scene::Transport::radiance);
            const spectral::SpectralSample back = scene::evaluate(bsdf, wi, wo, scene::Transport::radiance);
            const spectral::SpectralSample adjoint = scene::evaluate(bsdf, wi, wo, scene::Transport::importance);
            const bool passes = wo.z * wi.z < 0.0;
            for (std::size_t c = 0; c < spectral::kWavelengthsPerPath; ++c) {
                const double f = there[c] / std::abs(wi.z);
                EXPECT_NEAR(f, adjoint[c] / std::abs(wo.z), 1e-6 * f) << name;
                if (!passes || glass != nullptr) {
                    const double eta = passes ? (wo.z > 0.0 ? glass->eta[c] : 1.0 / glass->eta[c]) : 1.0;
                    EXPECT_NEAR(f * eta * eta, back[c] / std::abs(wo.z), 1e-6 * f * eta * eta) << name;
                }
            }
        }
    }
}

/// Cells of equal solid angle over the whole sphere.
constexpr int kRings = 20;
constexpr int kSectors = 24;
constexpr int kCells = kRings * kSectors;

int cell_of(const Vec3d& w) {
    const int ring = std::clamp(static_cast<int>((w.z + 1.0) * 0.5 * kRings), 0, kRings - 1);
    const double turn = std::atan2(w.y, w.x) / (2.0 * pi);
    const int sector = std::clamp(static_cast<int>((turn - std::floor(turn)) * kSectors), 0, kSectors - 1);
    return ring * kSectors + sector;
}

/// ∫ pdf over each cell.
std::vector<double> cell_probabilities(const scene::Bsdf& bsdf, const Vec3d& wo) {
    using Gauss = boost::math::quadrature::gauss<double, 20>;
    std::vector<double> probability;
    for (int cell = 0; cell < kCells; ++cell) {
        const int ring = cell / kSectors;
        const double from_mu = -1.0 + 2.0 * ring / kRings;
        const double from_phi = 2.0 * pi * (cell % kSectors) / kSectors;
        probability.push_back(Gauss::integrate(
            [&](double mu) {
                return Gauss::integrate(
                    [&](double phi) {
                        return scene::pdf(bsdf, wo, scene::direction(mu, phi), scene::Transport::radiance);
                    },
                    from_phi, from_phi + 2.0 * pi / kSectors);
            },
            from_mu, from_mu + 2.0 / kRings));
    }
    return probability;
}

// Pearson's test of what `sample` draws against the integral of what `pdf` says, over the sphere and one further
// cell for deltas and lost light. Cells that expect below 8 are pooled. A right sampler fails once in 10⁶ such tests;
// quadrature, whose error is below 1e-3 of a cell even at the edge where total reflection sets in, adds to χ² at most
// N · 1e-6, nothing.
TEST(Bsdf, DrawsDirectionsAsItsDensitySays) {
    constexpr int kSamples = 40000;
    scene::Uniform uniform(3);
    for (const auto& [name, bsdf] : scene::broad_cases(tables())) {
        for (const double mu : kViews) {
            const Vec3d wo = scene::direction(mu, 0.7);
            std::vector<double> expected = cell_probabilities(bsdf, wo);
            double total = 0.0;
            for (const double probability : expected) {
                total += probability;
            }
            ASSERT_LE(total, 1.0 + 1e-3) << name;
            expected.push_back(std::max(0.0, 1.0 - total));
            std::vector<int> drawn(expected.size());
            for (int i = 0; i < kSamples; ++i) {
                const auto s = scene::sample(bsdf, wo, scene::bsdf_numbers(uniform(), uniform(), uniform()),
                                             scene::Transport::radiance);
                ++drawn[static_cast<std::size_t>(s && !s->is_delta ? cell_of(s->wi) : kCells)];
            }
            double chi2 = 0.0;
            int cells = 0;
            double pooled_expected = 0.0;
            double pooled_drawn = 0.0;
            for (std::size_t cell = 0; cell < expected.size(); ++cell) {
                pooled_expected += kSamples * expected[cell];
                pooled_drawn += drawn[cell];
                if (pooled_expected >= 8.0) {
                    chi2 += std::pow(pooled_drawn - pooled_expected, 2) / pooled_expected;
                    ++cells;
                    pooled_expected = pooled_drawn = 0.0;
                }
            }
            EXPECT_LE(pooled_drawn, pooled_expected + 10.0 * std::sqrt(pooled_expected + 1.0)) << name;
            const boost::math::chi_squared distribution(cells - 1);
            EXPECT_LT(chi2, quantile(complement(distribution, 1e-6))) << name << " seen from " << mu;
        }
    }
}

}  // namespace lensproof::bsdf_sampling_test
