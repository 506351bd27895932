#include "engine/spectral/colour_matching.h"

#include <gtest/gtest.h>

#include <numeric>

#include "engine/spectral/illuminant.h"

namespace lensproof::spectral::colour_matching_test {

constexpr double kHalfOfFifthDecimal = 5e-6;

double sum(const Spectrum& spectrum) {
    return std::accumulate(spectrum.value.begin(), spectrum.value.end(), 0.0);
}

double sum_of_5_nm_steps(const Spectrum& spectrum) {
    double total = 0.0;
    for (int wavelength_nm = 380; wavelength_nm <= 780; wavelength_nm += 5) {
        total += spectrum(wavelength_nm);
    }
    return total;
}

/// As CIE 15:2004 computes it: a sum over 380 to 780 nm in steps of 5 nm.
Vec2d chromaticity_of_5_nm_sum(const Spectrum& spectrum, const ColourMatching& observer) {
    Vec3d xyz;
    for (int wavelength_nm = 380; wavelength_nm <= 780; wavelength_nm += 5) {
        const double power = spectrum(wavelength_nm);
        xyz = xyz + power * Vec3d{observer.x_bar(wavelength_nm), observer.y_bar(wavelength_nm),
                                  observer.z_bar(wavelength_nm)};
    }
    return chromaticity(xyz);
}

// The column sums that the CIE publishes with ISO/CIE 11664-1's 471 rows, to twelve decimals; adding them up here
// rounds by less than 471 · 1e-14.
TEST(ColourMatching, SumsAreThePublishedOnes) {
    const ColourMatching observer = cie_1931();
    EXPECT_EQ(observer.x_bar.value.size(), 471U);
    EXPECT_NEAR(sum(observer.x_bar), 106.865469489595, 5e-12);
    EXPECT_NEAR(sum(observer.y_bar), 106.856917101172, 5e-12);
    EXPECT_NEAR(sum(observer.z_bar), 106.892251278636, 5e-12);
}

// The sums under CIE 15:2004's 5 nm table, whose 81 entries are rounded to six decimals: 81 · 5e-7 at the very worst,
// √81 · 3e-7 to be expected.
TEST(ColourMatching, SumsOf5NmStepsAreThePublishedOnes) {
    const ColourMatching observer = cie_1931();
    EXPECT_NEAR(sum_of_5_nm_steps(observer.x_bar), 21.371524, 5e-6);
    EXPECT_NEAR(sum_of_5_nm_steps(observer.y_bar), 21.371327, 5e-6);
    EXPECT_NEAR(sum_of_5_nm_steps(observer.z_bar), 21.371540, 5e-6);
}

// The observer was made so that equal energy is white: x = y = 1/3, up to the residue of the published sums
// (106.865469 and 106.892251 against 106.856917, which moves y by 5e-5).
TEST(ColourMatching, EqualEnergyIsWhite) {
    const Vec2d white = chromaticity(tristimulus(illuminant("E").relative, cie_1931()));
    EXPECT_NEAR(white.x, 1.0 / 3.0, 5e-5);
    EXPECT_NEAR(white.y, 1.0 / 3.0, 5e-5);
}

// CIE 15:2004 states five decimals, from 5 nm sums.
TEST(ColourMatching, D65AndAStandWhereTheCiePutsThem) {
    const ColourMatching observer = cie_1931();
    const Vec2d d65 = chromaticity_of_5_nm_sum(illuminant("D65").relative, observer);
    EXPECT_NEAR(d65.x, 0.31272, kHalfOfFifthDecimal);
    EXPECT_NEAR(d65.y, 0.32903, kHalfOfFifthDecimal);
    const Vec2d a = chromaticity_of_5_nm_sum(illuminant("A").relative, observer);
    EXPECT_NEAR(a.x, 0.44757, 2 * kHalfOfFifthDecimal);  // 0.447575 here: a tie, which the tables round either way
    EXPECT_NEAR(a.y, 0.40745, kHalfOfFifthDecimal);
}

// The exact integrals agree with the 5 nm sums but for the bend of the functions within 5 nm: their second differences
// are up to 0.03 (z̄ near 440 nm) and change sign, which leaves a few 1e-5 of the total.
TEST(ColourMatching, ExactIntegralsAgreeWithTheSums) {
    const ColourMatching observer = cie_1931();
    const Vec2d d65 = chromaticity(tristimulus(illuminant("D65").relative, observer));
    EXPECT_NEAR(d65.x, 0.31272, 3e-5);
    EXPECT_NEAR(d65.y, 0.32903, 3e-5);
    const Vec2d a = chromaticity(tristimulus(illuminant("A").relative, observer));
    EXPECT_NEAR(a.x, 0.44757, 3e-5);
    EXPECT_NEAR(a.y, 0.40745, 3e-5);
}

// The SI fixes 683 lm/W at 540 THz: 555.016 nm in standard air. The third decimal of K_m = 683.002 is rounded.
TEST(ColourMatching, MaximumLuminousEfficacyFollowsFromTheSi) {
    const Spectrum v = photopic_efficiency();
    EXPECT_EQ(v(555.0), 1.0);
    EXPECT_NEAR(683.0 * v(555.0) / v(555.016), kMaximumLuminousEfficacy, 5e-4);
}

}  // namespace lensproof::spectral::colour_matching_test
