// Lenses as catalogues sell them: single elements, cylinders, collimators, diverging ones, for the infrared, each drawn
// as their makers' files draw them. Of 500 such files (Thorlabs's and Edmund Optics's, as another program brings them)
// 122 drew an error before these rules.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/spectral/wavelengths.h"
#include "tests/engine/check/checker_case.h"

namespace lensproof::check::stock_lenses_test {

// A half ball of N-BK7 at f/3.3, its sensor where the rays of three wavelengths together are sharpest: neither an
// error, nor a reason to suspect a digit.
TEST(StockLenses, ABestFocusOfAllWavelengthsIsNoSlip) {
    optics::Prescription lens = half_ball(3.0);
    lens.surfaces[0].medium = {.glass = "N-BK7"};
    lens.wavelengths_nm = {spectral::kLineD, spectral::kLineF, spectral::kLineC, 365.0};
    bool is_met = false;
    for (double mm = 15.0; mm < 18.9; mm += 0.02) {
        lens.surfaces[1].thickness_mm = mm;
        const CheckReport report = checked(lens);
        const optics::Finding* found = find(report, "back-focus", 2);
        ASSERT_NE(found, nullptr) << mm << said(report);
        if (found->severity == optics::Severity::info) {
            is_met = true;
            EXPECT_EQ(find(report, "suggestion"), nullptr) << mm << said(report);
        }
    }
    EXPECT_TRUE(is_met);
}

// A cylinder focuses in one plane: its best focus is that of the rays there, and a slip stays one.
TEST(StockLenses, ACylinderHasItsBestFocus) {
    optics::Prescription lens = half_ball(3.0);
    lens.surfaces[1].radius_x_mm = kInfinity;
    std::vector<double> meant_mm;
    for (double mm = 16.0; mm < 19.7; mm += 0.05) {
        lens.surfaces[1].thickness_mm = mm;
        const CheckReport report = checked(lens);
        const optics::Finding* found = find(report, "back-focus", 2);
        ASSERT_NE(found, nullptr) << mm << said(report);
        if (found->severity == optics::Severity::info) {
            meant_mm.push_back(mm);
        }
    }
    ASSERT_FALSE(meant_mm.empty());
    EXPECT_GT(meant_mm.front(), 17.5);
    EXPECT_LT(meant_mm.back(), 19.2);
}

// The virtual image of a diverging half ball is drawn where its real rays seem to come from.
TEST(StockLenses, AVirtualImageMayStandAtItsBestFocus) {
    optics::Prescription lens = half_ball(3.0);
    lens.surfaces[1].radius_mm = 10.0;
    std::vector<double> meant_mm;
    for (double mm = -22.0; mm < -16.0; mm += 0.05) {
        lens.surfaces[1].thickness_mm = mm;
        if (const CheckReport report = checked(lens); find(report, "virtual-image", 2) != nullptr) {
            EXPECT_EQ(find(report, "negative-power"), nullptr) << mm;
            meant_mm.push_back(mm);
        }
    }
    ASSERT_FALSE(meant_mm.empty());
    EXPECT_NEAR(meant_mm.front(), -20.1, 0.06) << "half a percent beyond the paraxial image";
    EXPECT_GT(meant_mm.back(), -19.0) << "the best focus lies nearer";
    EXPECT_LT(meant_mm.back(), -17.0);
}

// From an object in its front focal point light leaves a half ball parallel. Files state that object as a plane of air
// before the lens, at no distance from it: its beam is the lens's all the same.
TEST(StockLenses, ACollimatorImagesToInfinity) {
    optics::Prescription lens = half_ball();
    lens.object_distance_mm = 20.0 - 10.0 / 1.5;
    const CheckReport report = checked(lens);
    EXPECT_NE(find(report, "collimated", 2), nullptr) << said(report);
    EXPECT_EQ(find(report, "back-focus"), nullptr) << said(report);
    EXPECT_EQ(find(report, "blur"), nullptr) << said(report);
    EXPECT_TRUE(report.ok()) << said(report);
    lens.surfaces.insert(lens.surfaces.begin(), {.thickness_mm = lens.object_distance_mm, .semi_diameter_mm = 5.0});
    lens.object_distance_mm = 0.0;
    const CheckReport from_dummy = checked(lens);
    EXPECT_TRUE(from_dummy.ok()) << said(from_dummy);
    EXPECT_EQ(find(from_dummy, "marginal-ray"), nullptr) << said(from_dummy);
}

// Some catalogues put the image plane where the edge of the beam crosses the axis.
TEST(StockLenses, TheMarginalFocusIsNoSlip) {
    optics::Prescription lens = half_ball(3.0);
    // Sines: 1.5 · 3 / 10 behind a flat front, so the ray leaves at asin 0.45 − asin 0.3 to the axis.
    const double delta = std::asin(0.45) - std::asin(0.3);
    lens.surfaces[1].thickness_mm = 10.0 * (0.45 / std::sin(delta) - 1.0);
    const CheckReport report = checked(lens);
    const optics::Finding* found = find(report, "back-focus", 2);
    ASSERT_NE(found, nullptr) << said(report);
    EXPECT_EQ(found->severity, optics::Severity::info) << found->message;
    EXPECT_EQ(find(report, "suggestion"), nullptr) << said(report);
}

// A ball lens reaches to its equator, where its surface ends.
TEST(StockLenses, ABallsRimIsItsEquator) {
    optics::Prescription lens = half_ball();
    lens.surfaces[1].semi_diameter_mm = 10.0;
    EXPECT_EQ(find(checked(lens), "semi-diameter-beyond-sphere"), nullptr);
    lens.surfaces[1].semi_diameter_mm = 10.001;
    EXPECT_NE(find(checked(lens), "semi-diameter-beyond-sphere", 2), nullptr);
}

// One spherical element can be corrected for nothing; what two glasses or an asphere leave is a reason to ask.
TEST(StockLenses, ASingleElementsColourAndBlurAreItsNature) {
    optics::Prescription lens = half_ball(4.0);
    lens.surfaces[0].medium = {.glass = "N-SF11"};
    for (const char* code : {"axial-colour", "blur"}) {
        const CheckReport report = checked(lens);
        const optics::Finding* found = find(report, code);
        ASSERT_NE(found, nullptr) << said(report);
        EXPECT_EQ(found->severity, optics::Severity::info) << found->message;
    }
    lens.surfaces[1].conic = 0.5;
    const CheckReport aspheric = checked(lens);
    ASSERT_NE(find(aspheric, "blur"), nullptr) << said(aspheric);
    EXPECT_EQ(find(aspheric, "blur")->severity, optics::Severity::warning);
    lens.surfaces[1].conic = 0.0;
    lens.surfaces.push_back({.radius_mm = -30.0, .thickness_mm = 20.0, .semi_diameter_mm = 9.5});
    lens.surfaces[1].medium = {.glass = "N-BK7"};
    lens.surfaces[1].thickness_mm = 5.0;
    const CheckReport cemented = checked(lens);
    ASSERT_NE(find(cemented, "axial-colour"), nullptr) << said(cemented);
    EXPECT_EQ(find(cemented, "axial-colour")->severity, optics::Severity::warning);
}

// A catalogue states the beam that would fill the glass and, as both surfaces' rims, the clear aperture within it.
TEST(StockLenses, AClearApertureBelowTheStatedPupilIsNoError) {
    optics::Prescription lens = half_ball(4.05);
    lens.surfaces[1].semi_diameter_mm = 4.05;
    lens.aperture = {optics::ApertureKind::entrance_pupil_diameter, 9.0};
    const CheckReport product = checked(lens);
    const optics::Finding* found = find(product, "entrance-pupil", 1);
    ASSERT_NE(found, nullptr) << said(product);
    EXPECT_EQ(found->severity, optics::Severity::info) << found->message;
    lens.surfaces[1].semi_diameter_mm = 4.5;
    const CheckReport slip = checked(lens);
    ASSERT_NE(find(slip, "entrance-pupil", 1), nullptr) << said(slip);
    EXPECT_NE(find(slip, "entrance-pupil", 1)->severity, optics::Severity::info);
    lens.surfaces[0].semi_diameter_mm = lens.surfaces[1].semi_diameter_mm = 2.25;
    const CheckReport halved = checked(lens);
    ASSERT_NE(find(halved, "entrance-pupil", 1), nullptr) << said(halved);
    EXPECT_EQ(find(halved, "entrance-pupil", 1)->severity, optics::Severity::error);
}

// f/33 is slower than any camera lens is; where the file states that aperture too, no column is in other units.
TEST(StockLenses, ASlowLensMayBeStatedAsOne) {
    optics::Prescription lens = half_ball(0.3);
    EXPECT_NE(find(checked(lens), "f-number", 1), nullptr);
    lens.aperture = {optics::ApertureKind::entrance_pupil_diameter, 0.6};
    const CheckReport report = checked(lens);
    EXPECT_EQ(find(report, "f-number"), nullptr) << said(report);
}

// Germanium at 10.6 µm: an index of 4, and no claim in the visible.
TEST(StockLenses, ALensForTheInfraredIsJudgedThere) {
    optics::Prescription lens;
    lens.surfaces.resize(2);
    lens.surfaces[0] = {.radius_mm = 60.0,
                        .thickness_mm = 3.0,
                        .semi_diameter_mm = 5.0,
                        .medium = {.glass = "GERMANIUM"},
                        .is_stop = true};
    lens.surfaces[1] = {.thickness_mm = 19.23, .semi_diameter_mm = 5.0};
    lens.wavelengths_nm = {10600.0};
    const CheckReport report = checked(lens);
    for (const char* code : {"index-range", "dispersion-order"}) {
        EXPECT_EQ(find(report, code), nullptr) << said(report);
    }
    ASSERT_NE(find(report, "wavelength-range", 1), nullptr) << said(report);
    EXPECT_EQ(find(report, "wavelength-range", 1)->severity, optics::Severity::info);
    EXPECT_TRUE(report.ok()) << said(report);
}

}  // namespace lensproof::check::stock_lenses_test
