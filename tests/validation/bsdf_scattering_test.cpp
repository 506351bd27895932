// Furnaces: rough surfaces return what theory says of the light that falls on them, all of it where they should.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>

#include "engine/scene/bsdf/fresnel.h"
#include "tests/engine/scene/bsdf/bsdf_cases.h"
#include "tests/validation/measured.h"

namespace lensproof::bsdf_scattering_test {

using std::numbers::pi;

constexpr double kViews[] = {0.95, 0.6, 0.15, -0.9, -0.4};

/// The mean weight of samples.
Measured returned_light(const scene::Bsdf& bsdf, const Vec3d& wo, std::size_t wavelength, scene::Uniform& uniform) {
    std::vector<double> weights(40000);
    std::ranges::generate(weights, [&] {
        const auto drawn =
            scene::sample(bsdf, wo, scene::bsdf_numbers(uniform(), uniform(), uniform()), scene::Transport::importance);
        return drawn ? drawn->weight[wavelength] : 0.0;
    });
    return mean_of(weights);
}

/// Λ of Smith's masking for GGX, as a textbook has it (Heitz 2014, eq. 72 with 80).
double smith_lambda(const scene::Roughness& r, const Vec3d& w) {
    const double tan_alpha2 = (std::pow(r.alpha_x * w.x, 2) + std::pow(r.alpha_y * w.y, 2)) / (w.z * w.z);
    return 0.5 * (std::sqrt(1.0 + tan_alpha2) - 1.0);
}

/// The mean of `per_facet(m)` (wo·m)⁺ / (wo.z m.z) over all facets by the ground that they cover, seen or not: it is
/// even in azimuth and in u = tan²θ / (1 + tan²θ), θ being m's angle in the stretched frame. The integrand grows as
/// 1 / √(1 − u), which steps of √(1 − u) flatten. By the midpoint rule on 600 × 600 points.
template <class Function>
double facet_mean(const scene::Roughness& r, const Vec3d& wo, const Function& per_facet) {
    constexpr int kPoints = 600;
    double sum = 0.0;
    for (int i = 0; i < kPoints; ++i) {
        const double t = (i + 0.5) / kPoints;  // √(1 − u)
        const double slope = std::sqrt((1.0 - t) * (1.0 + t)) / t;
        for (int j = 0; j < kPoints; ++j) {
            const double phi = 2.0 * pi * (j + 0.5) / kPoints;
            const Vec3d m =
                normalized(Vec3d{-r.alpha_x * slope * std::cos(phi), -r.alpha_y * slope * std::sin(phi), 1.0});
            const double cosine = dot(wo, m);
            sum += cosine > 0.0 ? 2.0 * t * per_facet(m, cosine) * cosine / (wo.z * m.z) : 0.0;
        }
    }
    return sum / (kPoints * kPoints);
}

/// What single reflections at facets return of evenly spread light.
template <class Reflectance>
double single_reflections(const scene::Roughness& r, const Vec3d& wo, const Reflectance& reflectance) {
    return facet_mean(r, wo, [&](const Vec3d& m, double cosine) {
        const Vec3d wi = 2.0 * cosine * m - wo;
        return wi.z > 0.0 ? reflectance(cosine) / (1.0 + smith_lambda(r, wo) + smith_lambda(r, wi)) : 0.0;
    });
}

/// The same for what facets refract below.
double single_refractions(const scene::Roughness& r, const Vec3d& wo, double eta) {
    return facet_mean(r, wo, [&](const Vec3d& m, double cosine) {
        const double sin2 = (1.0 - cosine * cosine) / (eta * eta);
        if (sin2 >= 1.0) {
            return 0.0;
        }
        const Vec3d wi = -1.0 / eta * wo + (cosine / eta - std::sqrt(1.0 - sin2)) * m;
        return wi.z < 0.0 ? (1.0 - scene::dielectric_reflectance(eta, cosine)) /
                                ((1.0 + smith_lambda(r, wo)) * (1.0 + smith_lambda(r, wi)))
                          : 0.0;
    });
}

/// The quadrature's own error: the midpoint rule on a bounded integrand with a jump.
constexpr double kQuadrature = 2e-4;

// Smith's masking hides as much as makes the visible facets' area the surface's own: ∫ G₁ (wo·m)⁺ D dm = wo.z
// (Heitz 2014, eq. 14). The test's own formulae, to be compared with from here on.
TEST(RoughSurfaces, VisibleFacetsAddUpToTheSurface) {
    for (const scene::Roughness r :
         {scene::Roughness{0.1, 0.1}, scene::Roughness{0.5, 0.5}, scene::Roughness{0.6, 0.2}}) {
        for (const double mu : {0.95, 0.6, 0.15}) {
            const Vec3d wo = scene::direction(mu, 0.7);
            EXPECT_NEAR(facet_mean(r, wo, [&](const Vec3d&, double) { return 1.0 / (1.0 + smith_lambda(r, wo)); }), 1.0,
                        kQuadrature);
        }
    }
}

// A perfect metal's facets return all that they reflect out of the surface at once, and lose what falls on others.
TEST(RoughSurfaces, MetalLosesWhatFallsOnOtherFacets) {
    scene::Uniform uniform(4);
    for (const scene::Roughness r : {scene::Roughness{0.1, 0.1}, scene::Roughness{0.5, 0.5}, scene::Roughness{1.0, 1.0},
                                     scene::Roughness{0.6, 0.2}}) {
        const scene::Bsdf metal = scene::ConductorBsdf{
            .n = spectral::SpectralSample(0.0F), .k = spectral::SpectralSample(3.0F), .roughness = r};
        for (const double mu : {0.95, 0.6, 0.15}) {
            const Vec3d wo = scene::direction(mu, 0.7);
            const Measured returned = returned_light(metal, wo, 0, uniform);
            const double expected = single_reflections(r, wo, [](double) { return 1.0; });
            EXPECT_NEAR(returned.value, expected, 5.0 * returned.error + kQuadrature) << r.alpha_x << " " << mu;
            EXPECT_LE(returned.value, 1.0 + 1e-6);
        }
    }
}

// Head on, for α = 1, that has a closed form: facets tilted by θ cover as much ground at each u = sin² θ, mirror to
// cos 2θ = 1 − 2u, and are shadowed by 2 cos 2θ / (1 + cos 2θ), so ∫₀^½ (1 − 2u) / (1 − u) du = 1 − ln 2 returns.
TEST(RoughSurfaces, RoughestMetalReturnsOneLessLnTwo) {
    scene::Uniform uniform(11);
    const scene::Roughness r{.alpha_x = 1.0, .alpha_y = 1.0};
    const scene::Bsdf metal =
        scene::ConductorBsdf{.n = spectral::SpectralSample(0.0F), .k = spectral::SpectralSample(3.0F), .roughness = r};
    const Vec3d head_on{0.0, 0.0, 1.0};
    const Measured returned = returned_light(metal, head_on, 0, uniform);
    EXPECT_NEAR(returned.value, 1.0 - std::numbers::ln2, 5.0 * returned.error);
    EXPECT_NEAR(scene::FacetLosses::of_mirrors(r).at(head_on), std::numbers::ln2, 1e-3);
}

// Frosted glass, into it and out of it, at each of four wavelengths that disperse and share one direction: each
// returns what its own index makes of it, though three in four directions are drawn for another.
TEST(RoughSurfaces, GlassKeepsEachWavelengthsLight) {
    scene::Uniform uniform(5);
    const spectral::SpectralSample indices({1.45F, 1.5F, 1.6F, 1.8F});
    const scene::Roughness r{.alpha_x = 0.25, .alpha_y = 0.4};
    for (const bool is_dispersive : {false, true}) {
        for (const double mu : kViews) {
            const Vec3d wo = scene::direction(std::abs(mu), 0.7);
            for (std::size_t c = 0; c < spectral::kWavelengthsPerPath; c += is_dispersive ? 1 : 2) {
                const scene::Bsdf glass = scene::DielectricBsdf{
                    .eta = is_dispersive ? indices : spectral::SpectralSample(indices[c]), .roughness = r};
                const double eta = mu > 0.0 ? double{indices[c]} : 1.0 / double{indices[c]};
                const double expected =
                    single_reflections(r, wo,
                                       [&](double cosine) { return scene::dielectric_reflectance(eta, cosine); }) +
                    single_refractions(r, wo, eta);
                const Measured returned = returned_light(glass, scene::direction(mu, 0.7), c, uniform);
                EXPECT_NEAR(returned.value, expected, 5.0 * returned.error + kQuadrature) << mu << " " << indices[c];
                EXPECT_LE(returned.value, 1.0 + 5.0 * returned.error);
            }
        }
    }
}

// A white furnace stays white: rough metal that mirrors everything returns everything, whatever its roughness and way
// of brushing, once what single scattering loses is given back; to the tables' 2e-3.
TEST(RoughSurfaces, PerfectMetalLosesNothing) {
    scene::Uniform uniform(8);
    for (const scene::Roughness r : {scene::Roughness{0.1, 0.1}, scene::Roughness{0.5, 0.5}, scene::Roughness{1.0, 1.0},
                                     scene::Roughness{0.6, 0.2}}) {
        const scene::FacetLosses losses = scene::FacetLosses::of_mirrors(r);
        const scene::Bsdf metal = scene::ConductorBsdf{
            .n = spectral::SpectralSample(0.0F),
            .k = spectral::SpectralSample(3.0F),
            .roughness = r,
            .losses = &losses,
            .given_back = spectral::SpectralSample(static_cast<float>(scene::given_back(1.0, losses.mean())))};
        for (const double mu : {0.99, 0.6, 0.15, 0.02}) {
            for (const double phi : {0.0, 0.7, 1.4}) {
                const Measured returned = returned_light(metal, scene::direction(mu, phi), 0, uniform);
                EXPECT_NEAR(returned.value, 1.0, 5.0 * returned.error + 2e-3) << r.alpha_x << " " << mu << " " << phi;
            }
        }
    }
}

// So does frosted glass, from within and from without, at each of the wavelengths that share a direction, those between
// the tables' indices too.
TEST(RoughSurfaces, GlassLosesNothing) {
    scene::Uniform uniform(9);
    const spectral::SpectralSample indices({1.45F, 1.5F, 1.6F, 1.8F});
    for (const scene::Roughness r :
         {scene::Roughness{0.15, 0.15}, scene::Roughness{0.7, 0.7}, scene::Roughness{0.5, 0.2}}) {
        const scene::BoundaryLosses losses(r, 1.45, 1.8);
        const scene::Bsdf glass = scene::DielectricBsdf{.eta = indices, .roughness = r, .losses = &losses};
        for (const double mu : {0.99, 0.5, 0.05, -0.95, -0.7, -0.1}) {
            for (const std::size_t c : {0U, 2U}) {
                const Measured returned = returned_light(glass, scene::direction(mu, 0.5), c, uniform);
                EXPECT_NEAR(returned.value, 1.0, 5.0 * returned.error + 2e-3) << r.alpha_x << " " << mu << " " << c;
            }
        }
    }
}

// What is lost of evenly spread light, as tabulated, against the mean over directions of what theory says at each:
// Gauss's rule in μ on the test's own quadrature.
TEST(RoughSurfaces, LossesAreWhatTheoryLeaves) {
    using Gauss = boost::math::quadrature::gauss<double, 10>;
    const scene::Roughness r{.alpha_x = 0.5, .alpha_y = 0.5};
    const auto lost = [&](double mu) {
        return 1.0 - single_reflections(r, scene::direction(mu, 0.7), [](double) { return 1.0; });
    };
    const scene::FacetLosses losses = scene::FacetLosses::of_mirrors(r);
    for (const double mu : {0.05, 0.3, 0.9}) {
        EXPECT_NEAR(losses.at(scene::direction(mu, 0.2)), lost(mu), 1e-3) << mu;
    }
    EXPECT_NEAR(losses.mean(), Gauss::integrate([&](double mu) { return 2.0 * mu * lost(mu); }, 0.0, 1.0), 1e-3);
}

// At grazing angles, at the finest and the coarsest roughness, everything stays finite, and no weight exceeds what one
// of four wavelengths can: 4 of its own pdf, and 1/η² for radiance that leaves the denser side.
TEST(RoughSurfaces, StayFiniteAtGrazing) {
    scene::Uniform uniform(10);
    for (const double alpha : {scene::kLeastAlpha, 0.01, 1.0}) {
        const scene::Roughness r{.alpha_x = alpha, .alpha_y = alpha};
        const scene::FacetLosses mirrors = scene::FacetLosses::of_mirrors(r);
        const scene::BoundaryLosses boundary(r, 1.45, 1.8);
        const scene::DielectricCoat coat(1.5, alpha);
        const scene::Bsdf surfaces[] = {
            scene::ConductorBsdf{.n = spectral::SpectralSample(0.1F),
                                 .k = spectral::SpectralSample(4.0F),
                                 .roughness = r,
                                 .losses = &mirrors,
                                 .given_back = spectral::SpectralSample(0.9F)},
            scene::DielectricBsdf{
                .eta = spectral::SpectralSample({1.45F, 1.5F, 1.6F, 1.8F}), .roughness = r, .losses = &boundary},
            scene::DielectricBsdf{.eta = spectral::SpectralSample(1.6F), .roughness = r, .losses = &boundary},
            scene::plastic_bsdf(spectral::SpectralSample(0.7F), coat)};
        for (const scene::Bsdf& surface : surfaces) {
            for (int i = 0; i < 4000; ++i) {
                const double mu = std::pow(10.0, -12.0 * uniform()) * (i % 2 == 0 ? 1.0 : -1.0);
                const Vec3d wo = scene::direction(mu, 2.0 * pi * uniform());
                const auto drawn = scene::sample(surface, wo, scene::bsdf_numbers(uniform(), uniform(), uniform()),
                                                 scene::Transport::radiance);
                if (drawn) {
                    EXPECT_TRUE(std::isfinite(drawn->pdf) && drawn->pdf > 0.0) << alpha << " " << mu;
                    for (std::size_t m = 0; m < spectral::kWavelengthsPerPath; ++m) {
                        const float weight = drawn->weight[m];
                        EXPECT_TRUE(weight >= 0.0F && weight <= 4.0F * 1.8F * 1.8F * 1.01F) << weight << " " << alpha;
                    }
                }
                const Vec3d wi = scene::random_direction(uniform);
                const spectral::SpectralSample value = scene::evaluate(surface, wo, wi, scene::Transport::importance);
                EXPECT_TRUE(std::isfinite(spectral::max_value(value)) && spectral::max_value(value) >= 0.0F)
                    << alpha << " " << mu;
            }
        }
    }
}

// White pigment under varnish returns all light, smooth or rough, and black pigment what the top of the varnish does
// (Fresnel's; single reflections). The rough coat's table is within 1e-3.
TEST(RoughSurfaces, WhiteVarnishLosesNothing) {
    scene::Uniform uniform(6);
    for (const double alpha : {0.0, 0.1, 0.3, 0.8}) {
        const scene::DielectricCoat coat(1.5, alpha);
        const scene::Bsdf white = scene::plastic_bsdf(spectral::SpectralSample(1.0F), coat);
        const scene::Bsdf black = scene::plastic_bsdf(spectral::SpectralSample(0.0F), coat);
        for (const double mu : {0.95, 0.6, 0.15, 0.03}) {
            const Vec3d wo = scene::direction(mu, 0.7);
            const Measured all = returned_light(white, wo, 0, uniform);
            EXPECT_NEAR(all.value, 1.0, 5.0 * all.error + (alpha == 0.0 ? 1e-6 : 1e-3)) << alpha << " " << mu;
            const auto fresnel = [](double cosine) { return scene::dielectric_reflectance(1.5, cosine); };
            const double top = alpha == 0.0 ? fresnel(mu) : single_reflections({alpha, alpha}, wo, fresnel);
            const Measured gloss = returned_light(black, wo, 0, uniform);
            EXPECT_NEAR(gloss.value, top, 5.0 * gloss.error + (alpha == 0.0 ? 1e-6 : kQuadrature))
                << alpha << " " << mu;
            EXPECT_NEAR(coat.reflectance(mu), top, alpha == 0.0 ? 1e-15 : 1e-3 + kQuadrature) << alpha << " " << mu;
        }
    }
}

// Saunderson: grey pigment under a smooth coat returns E + (1 − E) ρ (1 − F̄) / (1 − ρ F̄) in all.
TEST(RoughSurfaces, GreyVarnishIsSaundersons) {
    scene::Uniform uniform(7);
    const scene::DielectricCoat varnish(1.5, 0.0);
    const double below = varnish.mean_reflectance_below();
    for (const float rho : {0.2F, 0.5F, 0.9F}) {
        const Vec3d wo = scene::direction(0.8, 0.7);
        const Measured returned =
            returned_light(scene::plastic_bsdf(spectral::SpectralSample(rho), varnish), wo, 2, uniform);
        const double top = scene::dielectric_reflectance(1.5, 0.8);
        const double expected = top + (1.0 - top) * rho * (1.0 - below) / (1.0 - rho * below);
        EXPECT_NEAR(returned.value, expected, 5.0 * returned.error + 1e-6) << rho;
    }
}

}  // namespace lensproof::bsdf_scattering_test
