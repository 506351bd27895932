// Smooth boundaries: Fresnel, Snell, and no light lost.
#include "engine/scene/bsdf/fresnel.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>

#include "tests/engine/scene/bsdf/bsdf_cases.h"

namespace lensproof::scene::fresnel_test {

constexpr auto kRadiance = Transport::radiance;
constexpr double kFloatRounding = 0x1p-24;

spectral::SpectralSample conductor_at(float n, float k, double cos_incidence) {
    return conductor_reflectance(spectral::SpectralSample(n), spectral::SpectralSample(k), cos_incidence);
}

// ((n − 1)² + k²) / ((n + 1)² + k²) head on (Born & Wolf, §14.2, eq. 15), for metals from silver to chromium; and the
// dielectric's ((n − 1) / (n + 1))² as k vanishes. A dozen float operations without cancellation but in n − 1.
TEST(Fresnel, HeadOnAsTheIndexSays) {
    for (const auto& [n, k] :
         {std::pair{0.05F, 3.586F}, {0.29F, 2.863F}, {1.02F, 2.577F}, {3.18F, 3.33F}, {1.5F, 0.0F}}) {
        const double expected = ((n - 1.0) * (n - 1.0) + k * k) / ((n + 1.0) * (n + 1.0) + k * k);
        EXPECT_NEAR(conductor_at(n, k, 1.0)[0], expected, 12 * kFloatRounding);
    }
    EXPECT_NEAR(dielectric_reflectance(1.5, 1.0), 0.04, 4e-16);
    EXPECT_NEAR(dielectric_reflectance(1.0 / 1.5, 1.0), 0.04, 4e-16);
}

// The complex formulae themselves, in double and by complex numbers: r_s = (c − q) / (c + q), r_p = (N² c − q) /
// (N² c + q) with q = √(N² − s²) (Born & Wolf, §1.5.2 with a complex index).
TEST(Fresnel, ConductorsAreTheComplexFormulae) {
    for (const std::complex<double> index :
         {std::complex(0.05, 3.586), {1.45, 1.948}, {3.18, 3.33}, {0.6, 7.3}, {0.4, 0.3}}) {
        for (const double c : {1.0, 0.8, 0.5, 0.2, 0.05, 0.001}) {
            const std::complex<double> q = std::sqrt(index * index - (1.0 - c * c));
            const double s = std::norm((c - q) / (c + q));
            const double p = std::norm((index * index * c - q) / (index * index * c + q));
            const float computed =
                conductor_at(static_cast<float>(index.real()), static_cast<float>(index.imag()), c)[0];
            EXPECT_NEAR(computed, 0.5 * (s + p), 20 * kFloatRounding) << index << " at " << c;
        }
    }
}

// At Brewster's angle, tan i = n, the p part passes whole: what comes back is half of R_s = ((n² − 1) / (n² + 1))². As
// a metal without absorption the same.
TEST(Fresnel, AtBrewstersAngleOnlyHalfOfTheLightCanReflect) {
    for (const double n : {1.33, 1.5, 1.9, 2.4}) {
        const double cos_brewster = 1.0 / std::sqrt(1.0 + n * n);
        const double s = std::pow((n * n - 1.0) / (n * n + 1.0), 2);
        EXPECT_NEAR(dielectric_reflectance(n, cos_brewster), 0.5 * s, 1e-15);
        EXPECT_NEAR(conductor_at(static_cast<float>(n), 0.0F, cos_brewster)[0], 0.5 * s, 12 * kFloatRounding);
    }
}

// From the dense side nothing passes beyond sin i = 1/n, and a little just within: 1e-6 rad inside the critical angle
// the cosine behind is about √(2e-6 n cos i_c), as steep a rise as Fresnel's.
TEST(Fresnel, ReflectsTotallyBeyondTheCriticalAngle) {
    constexpr double kIndex = 1.5;
    const double critical = std::asin(1.0 / kIndex);
    EXPECT_EQ(dielectric_reflectance(1.0 / kIndex, std::cos(critical + 1e-6)), 1.0);
    EXPECT_EQ(dielectric_reflectance(1.0 / kIndex, 0.0), 1.0);
    EXPECT_LT(dielectric_reflectance(1.0 / kIndex, std::cos(critical - 1e-6)), 0.999);
    const Bsdf glass = DielectricBsdf{.eta = spectral::SpectralSample(1.5F)};
    const Vec3d inside = direction(-std::cos(critical + 1e-3), 0.3);
    for (const double u : {0.01, 0.5, 0.99}) {
        const auto drawn = sample(glass, inside, bsdf_numbers(u, 0.5, 0.5), kRadiance);
        ASSERT_TRUE(drawn);
        EXPECT_EQ(drawn->wi, (Vec3d{-inside.x, -inside.y, inside.z}));
        EXPECT_EQ(drawn->weight, spectral::SpectralSample(1.0F));
    }
}

// Snell: n sin i is the same on both sides, and the ray stays in its plane, for whichever wavelength is the hero; the
// others stay behind. Into the glass and out of it. Rounding of a unit vector's sine, whatever the float index.
TEST(Dielectric, EachHeroFollowsSnellAlone) {
    const std::array<float, spectral::kWavelengthsPerPath> indices{1.51F, 1.52F, 1.535F, 1.56F};
    for (std::size_t hero = 0; hero < indices.size(); ++hero) {
        auto of_hero = indices;
        std::swap(of_hero[0], of_hero[hero]);
        const DielectricBsdf glass{.eta = spectral::SpectralSample(of_hero)};
        for (const double mu : {0.99, 0.7, 0.2, -0.95, -0.8}) {
            const Vec3d wo = direction(mu, 0.4);
            const auto drawn = sample(Bsdf(glass), wo, bsdf_numbers(0.999, 0.5, 0.5), kRadiance);
            ASSERT_TRUE(drawn);
            ASSERT_LT(drawn->wi.z * wo.z, 0.0);
            const double eta = mu > 0.0 ? double{indices[hero]} : 1.0 / double{indices[hero]};
            EXPECT_NEAR(drawn->wi.x * eta, -wo.x, 2e-15);
            EXPECT_NEAR(drawn->wi.y * eta, -wo.y, 2e-15);
            EXPECT_NEAR(length(drawn->wi), 1.0, 2e-15);
            EXPECT_TRUE(drawn->is_dispersed);
            EXPECT_TRUE(drawn->is_delta);
            EXPECT_NEAR(drawn->weight[0] * eta * eta, 1.0, 4 * kFloatRounding);
            EXPECT_EQ(drawn->weight, spectral::hero_alone(drawn->weight));
        }
    }
}

// Mirrors do not disperse: all wavelengths come back from a prism's face, and over the hero's chance of doing so each
// weighs its own reflectance. Two float divisions.
TEST(Dielectric, ReflectionKeepsAllWavelengths) {
    const spectral::SpectralSample indices({1.5F, 1.55F, 1.6F, 1.7F});
    const Vec3d wo = direction(0.6, 1.0);
    const auto drawn = sample(Bsdf(DielectricBsdf{.eta = indices}), wo, bsdf_numbers(1e-3, 0.5, 0.5), kRadiance);
    ASSERT_TRUE(drawn);
    EXPECT_FALSE(drawn->is_dispersed);
    EXPECT_EQ(drawn->wi, (Vec3d{-wo.x, -wo.y, wo.z}));
    for (std::size_t i = 0; i < spectral::kWavelengthsPerPath; ++i) {
        const double expected = dielectric_reflectance(indices[i], 0.6) / dielectric_reflectance(indices[0], 0.6);
        EXPECT_NEAR(drawn->weight[i], expected, 4 * kFloatRounding * expected);
    }
}

// A smooth boundary loses nothing whichever way light goes: importance weighs 1 in both, radiance 1 and 1/η², the
// radiance within being η² as much. A perfect metal and white paint return everything. Exactly: nothing is estimated.
TEST(SmoothSurfaces, KeepAllLight) {
    const Bsdf glass = DielectricBsdf{.eta = spectral::SpectralSample(1.5F)};
    for (const double mu : {1.0, 0.9, 0.3, 0.01, -1.0, -0.9, -0.3}) {
        const double eta = mu > 0.0 ? 1.5 : 1.0 / 1.5;
        for (const double u : {1e-9, 0.02, 0.1, 0.6, 0.999}) {
            const auto importance = sample(glass, direction(mu, 2.0), bsdf_numbers(u, 0.5, 0.5), Transport::importance);
            const auto radiance = sample(glass, direction(mu, 2.0), bsdf_numbers(u, 0.5, 0.5), Transport::radiance);
            ASSERT_TRUE(importance && radiance);
            EXPECT_EQ(importance->weight, spectral::SpectralSample(1.0F));
            const bool passes = radiance->wi.z * mu < 0.0;
            EXPECT_EQ(radiance->weight,
                      spectral::SpectralSample(passes ? static_cast<float>(1.0 / (eta * eta)) : 1.0F));
        }
        const Bsdf mirror = ConductorBsdf{.n = spectral::SpectralSample(0.0F), .k = spectral::SpectralSample(3.0F)};
        const Bsdf paint = DiffuseBsdf{.albedo = spectral::SpectralSample(1.0F)};
        EXPECT_EQ(sample(mirror, direction(mu, 2.0), bsdf_numbers(0.5, 0.5, 0.5), kRadiance)->weight,
                  spectral::SpectralSample(1.0F));
        EXPECT_EQ(sample(paint, direction(mu, 2.0), bsdf_numbers(0.5, 0.5, 0.5), kRadiance)->weight,
                  spectral::SpectralSample(1.0F));
    }
}

// The internal and external mean reflectances of a smooth boundary in closed form: S. Q. Duntley, J. Opt. Soc. Am. 32,
// 61 (1942), by integration of Fresnel's formulae over a Lambertian hemisphere. For η = 1.5 they are 0.0918 and 0.596.
TEST(DielectricCoat, MeanReflectanceIsDuntleys) {
    for (const double n : {1.2, 1.33, 1.5, 1.9}) {
        const double n2 = n * n;
        const double external =
            0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * std::pow(n + 1.0, 2)) +
            n2 * std::pow(n2 - 1.0, 2) / std::pow(n2 + 1.0, 3) * std::log((n - 1.0) / (n + 1.0)) -
            2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n2 * n2 - 1.0)) +
            8.0 * n2 * n2 * (n2 * n2 + 1.0) / ((n2 + 1.0) * std::pow(n2 * n2 - 1.0, 2)) * std::log(n);
        const DielectricCoat coat(n, 0.0);
        EXPECT_NEAR(coat.mean_reflectance(), external, 1e-6) << n;
        EXPECT_NEAR(coat.mean_reflectance_below(), 1.0 - (1.0 - external) / n2, 1e-6) << n;
    }
    EXPECT_NEAR(DielectricCoat(1.5, 0.0).mean_reflectance(), 0.0918, 5e-5);
    EXPECT_NEAR(DielectricCoat(1.5, 0.0).mean_reflectance_below(), 0.596, 5e-4);
}

// What has no pdf is said to be a delta, parts of a mix included.
TEST(Bsdf, KnowsWhereLightsNeedNotBeSampled) {
    const BsdfTables tables;
    for (const auto& [name, bsdf] : broad_cases(tables)) {
        EXPECT_FALSE(is_delta(bsdf)) << name;
    }
    const DielectricBsdf glass{.eta = spectral::SpectralSample(1.5F)};
    const ConductorBsdf mirror{.n = spectral::SpectralSample(0.2F), .k = spectral::SpectralSample(3.0F)};
    MixBsdf mix;
    mix.count = 2;
    mix.part = {glass, mirror};
    mix.fraction = {0.5, 0.5};
    EXPECT_TRUE(is_delta(Bsdf(glass)));
    EXPECT_TRUE(is_delta(Bsdf(mirror)));
    EXPECT_TRUE(is_delta(Bsdf(mix)));
    mix.part[1] = DiffuseBsdf{.albedo = spectral::SpectralSample(0.5F)};
    EXPECT_FALSE(is_delta(Bsdf(mix)));
    EXPECT_TRUE(is_delta(Bsdf(plastic_bsdf(spectral::SpectralSample(0.0F), tables.smooth_coat))));
    EXPECT_EQ(normal_albedo(Bsdf(mix)), spectral::SpectralSample(0.75F));
    const spectral::SpectralSample coated =
        normal_albedo(Bsdf(plastic_bsdf(spectral::SpectralSample(1.0F), tables.smooth_coat)));
    EXPECT_NEAR(coated[0], 1.0, 2 * kFloatRounding);
}

}  // namespace lensproof::scene::fresnel_test
