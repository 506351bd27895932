#include "engine/spectral/illuminant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "engine/base/input_error.h"
#include "engine/spectral/colour_matching.h"
#include "engine/spectral/planck.h"
#include "tests/complaint.h"

namespace lensproof::spectral::illuminant_test {

constexpr double kStefanBoltzmann = 5.670374419e-8;  // W·m⁻²·K⁻⁴, CODATA 2018: exact, cut after ten digits
constexpr double kWien = 2.897771955e6;              // nm·K, CODATA 2018: exact, cut after ten digits

Vec2d cie_1960_uv(const Vec2d& xy) {
    const double denominator = -2.0 * xy.x + 12.0 * xy.y + 3.0;
    return {4.0 * xy.x / denominator, 6.0 * xy.y / denominator};
}

/// Points of the Planckian locus in CIE 1960 (u, v), to five decimals, at reciprocal temperatures in 1/MK:
/// A. R. Robertson, "Computation of correlated color temperature and distribution temperature", J. Opt. Soc. Am. 58,
/// 1528 (1968); c₂ = 1.4388e-2 m·K.
struct LocusPoint {
    double mired;
    Vec2d uv;
};
constexpr LocusPoint kRobertson[] = {
    {50.0, {0.18388, 0.27709}},  {100.0, {0.19032, 0.29326}}, {150.0, {0.19962, 0.30921}}, {200.0, {0.21142, 0.32312}},
    {300.0, {0.24010, 0.34308}}, {400.0, {0.27218, 0.35407}}, {500.0, {0.30505, 0.35907}}, {600.0, {0.33724, 0.36051}}};

// π ∫ L dλ = σ T⁴. As a sum over equal steps of ln λ, which for an integrand that vanishes smoothly at both ends
// converges faster than any power of the step. Beyond λT = 1e10 nm·K less than 1e-9 remains; below 1e4 nothing that
// double can hold.
TEST(Planck, TotalIsStefanAndBoltzmanns) {
    for (const double temperature_k : {500.0, 2856.0, 6500.0, 100000.0}) {
        constexpr int kSteps = 1400;
        const double from = std::log(1e4 / temperature_k);
        const double step = std::log(1e10 / 1e4) / kSteps;
        double total = 0.0;
        for (int i = 0; i < kSteps; ++i) {
            const double wavelength_nm = std::exp(from + i * step);
            total += planck_radiance(wavelength_nm, temperature_k) * wavelength_nm * step;
        }
        const double expected = kStefanBoltzmann * std::pow(temperature_k, 4);
        EXPECT_NEAR(std::numbers::pi * total / expected, 1.0, 1e-9);
    }
}

// λ_max T = b. One part in 1e4 to either side the radiance has fallen by about 2.5e-8, far above rounding.
TEST(Planck, PeakIsWiens) {
    for (const double temperature_k : {500.0, 2856.0, 6500.0}) {
        const double peak_nm = kWien / temperature_k;
        const double peak = planck_radiance(peak_nm, temperature_k);
        EXPECT_GT(peak, planck_radiance(peak_nm * (1.0 + 1e-4), temperature_k));
        EXPECT_GT(peak, planck_radiance(peak_nm * (1.0 - 1e-4), temperature_k));
    }
}

// ISO/CIE 11664-2 defines A by S = 100 (560/λ)⁵ (exp(1.435e7/(2848·560)) − 1) / (exp(1.435e7/(2848 λ)) − 1), to six
// digits.
TEST(Illuminant, AIsItsDefinition) {
    const Spectrum a = illuminant("A").relative;
    ASSERT_EQ(a.wavelength_nm.size(), 107U);
    for (std::size_t i = 0; i < a.value.size(); ++i) {
        const double ratio = 560.0 / a.wavelength_nm[i];
        const double defined = 100.0 * std::pow(ratio, 5) * std::expm1(1.435e7 / (2848.0 * 560.0)) /
                               std::expm1(1.435e7 / (2848.0 * a.wavelength_nm[i]));
        EXPECT_NEAR(a.value[i] / defined, 1.0, 5e-6) << a.wavelength_nm[i];
    }
}

// The same light by today's constants: 2848 K · c₂ / 1.435e-2 m·K = 2855.5 K (CIE 15:2004 says "approximately
// 2856 K"). The chromaticity is CIE's; integrals against its 5 nm sums as in
// ColourMatching.ExactIntegralsAgreeWithTheSums.
TEST(Illuminant, BlackbodyOf2855KelvinHasTheColourOfA) {
    const Vec2d xy = chromaticity(tristimulus(illuminant("blackbody:2855.5").relative, cie_1931()));
    EXPECT_NEAR(xy.x, 0.44757, 3e-5);
    EXPECT_NEAR(xy.y, 0.40745, 3e-5);
}

// Half of the table's last digit, and 1e-5 between its sums and our integrals. Its temperatures count by its c₂.
TEST(Illuminant, BlackbodiesLieOnThePlanckianLocus) {
    const ColourMatching observer = cie_1931();
    const double c2 = kPlanckConstant * kSpeedOfLight / kBoltzmannConstant;
    for (const LocusPoint& point : kRobertson) {
        const double temperature_k = 1e6 / point.mired * c2 / 1.4388e-2;
        const Illuminant light = illuminant("blackbody:" + std::to_string(temperature_k));
        const Vec2d uv = cie_1960_uv(chromaticity(tristimulus(light.relative, observer)));
        EXPECT_NEAR(uv.x, point.uv.x, 1.5e-5) << point.mired;
        EXPECT_NEAR(uv.y, point.uv.y, 1.5e-5) << point.mired;
    }
}

// 100 cd/m² of equal energy is 100 / (683.002 · 106.8569) W·m⁻²·sr⁻¹·nm⁻¹ everywhere: the published sum of V(λ) times
// its 1 nm. The trapezium rule counts its ends by half, 2e-6 of 107; K_m and the sum have six digits or more.
TEST(Illuminant, LuminanceSetsTheRadiance) {
    const Spectrum radiance = radiance_of(illuminant("E"), 100.0);
    EXPECT_NEAR(radiance(555.0) * 683.002 * 106.856917 / 100.0, 1.0, 1e-7);
    EXPECT_EQ(radiance(400.0), radiance(700.0));
}

// A light meter reads back what was asked for: a sum of 1000 terms, so 1e-13 is generous.
TEST(Illuminant, ALightMeterReadsWhatWasAsked) {
    for (const char* name : {"D65", "A", "E", "blackbody:3200", "blackbody:500"}) {
        EXPECT_NEAR(tristimulus(radiance_of(illuminant(name), 250.0), cie_1931()).y, 250.0, 250.0 * 1e-13) << name;
        EXPECT_NEAR(tristimulus(irradiance_of(illuminant(name), 0.78), cie_1931()).y, 0.78, 0.78 * 1e-13) << name;
    }
}

TEST(Illuminant, UnknownNamesAreRefusedWithTheKnownOnes) {
    for (const char* name : {"", "D75", "d65", "blackbody", "blackbody:", "blackbody:warm", "blackbody:3200K",
                             "blackbody:-3", "blackbody:499", "blackbody:1e6", "blackbody:nan", "blackbody:inf"}) {
        EXPECT_THROW(illuminant(name), InputError) << name;
    }
    EXPECT_EQ(complaint_about([] { illuminant("D75"); }),
              "illuminant 'D75' is not known: expected one of D65, D50, A, F1, F2, F3, F4, F5, F6, F7, F8, F9, F10, "
              "F11, F12, E, blackbody:<kelvin>");
}

}  // namespace lensproof::spectral::illuminant_test
