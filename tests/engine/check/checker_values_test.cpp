// Findings about the table itself, its glasses and its first-order data, each with the value that a closed form gives.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/formats/glass/shipped_glasses.h"
#include "engine/formats/prescription/prescription_file.h"
#include "tests/complaint.h"
#include "tests/engine/check/checker_case.h"

namespace lensproof::check::checker_values_test {

using P = optics::Prescription;

optics::Prescription tessar() {
    return formats::read_prescription(formats::find_lens_file("tessar"));
}

/// Of a sphere: R − √(R² − r²).
double sphere_sag(double radius, double r) {
    return radius - std::sqrt(radius * radius - r * r);
}

// Both rims are wider than the other surface's clear aperture, so they lie against each other; the gap there is
// t + sag(183.92, 16.5) − sag(40.93, 17.3) = 3 + 0.7416 − 3.8354 mm, while the clear apertures still miss each other.
TEST(CheckerValues, RimsOverlapByTheSagsLessTheGap) {
    optics::Prescription rimmed = tessar();
    rimmed.surfaces[5].rim_mm = 20.0;
    rimmed.surfaces[6].rim_mm = 20.0;
    const auto close_up = [](P& p) { p.surfaces[5].thickness_mm = 3.0; };
    const double gap = 3.0 + sphere_sag(183.92, 16.5) - sphere_sag(40.93, 17.3);
    ASSERT_LT(gap, 0.0);
    expect_planted(rimmed, close_up, {"rims-overlap", optics::Severity::warning, 6, gap});
    close_up(rimmed);
    EXPECT_EQ(find(checked(rimmed), "surfaces-cross", 6), nullptr);

    rimmed.surfaces[6].rim_mm = 17.0;  // inside the surface before it
    EXPECT_EQ(find(checked(rimmed), "rims-overlap"), nullptr);
}

TEST(CheckerValues, SurfacesCementedWithAnAirGapOughtToBeAlike) {
    optics::Prescription split = tessar();
    split.surfaces.insert(split.surfaces.begin() + 1, split.surfaces[1]);
    split.surfaces[1].thickness_mm = 0.01;
    split.surfaces[1].medium = {};
    const double front = split.surfaces[1].radius_mm;
    const double reach = *split.surfaces[1].semi_diameter_mm;
    expect_planted(split, [&](P& p) { p.surfaces[2].radius_mm = front - 1.0; },
                   {"cemented-surfaces", optics::Severity::warning, 2, 1.0});
    expect_planted(split, [&](P& p) { p.surfaces[2].semi_diameter_mm = reach - 3.0; },
                   {"cemented-surfaces", optics::Severity::warning, 2, 3.0});
}

// Of a conic with k = 3 and R = 10, the sag is real up to R / √(1 + k) = 5 mm.
TEST(CheckerValues, AnAsphereEndsWhereItsConicDoes) {
    optics::Prescription lens = half_ball();
    lens.surfaces[1].semi_diameter_mm = 4.9;
    lens.surfaces[1].conic = 3.0;
    const auto widen = [](P& p) { p.surfaces[1].semi_diameter_mm = 6.0; };
    expect_planted(lens, widen, {"asphere-ends", optics::Severity::warning, 2, 5.0, 1e-12, 6.0});
    lens.surfaces[1].asphere[1] = 1e-9;
    expect_planted(lens, widen, {"asphere-ends", optics::Severity::error, 2, 5.0, 1e-12, 6.0});
}

// z = −r² / 100 + 5e-5 r⁴: dz/dr = −0.02 r + 2e-4 r³ is zero at r = √(0.02 / 2e-4) = 10 mm.
TEST(CheckerValues, AnAsphereTurnsOverWhereItsSlopeIsZero) {
    optics::Prescription lens = half_ball();
    lens.surfaces[1].radius_mm = -50.0;
    lens.surfaces[1].conic = -1.0;
    lens.surfaces[1].asphere[1] = 5e-5;
    lens.surfaces[1].semi_diameter_mm = 9.9;
    expect_planted(lens, [](P& p) { p.surfaces[1].semi_diameter_mm = 14.0; },
                   {"asphere-turns-over", optics::Severity::warning, 2, 10.0, 1e-9, 14.0});
}

// Biconvex, n = 1.5, R = ±10: 1 / R_P = −2 (n − 1) / (n R) whatever the thickness t, and
// 1 / f = (n − 1) (2 / R − (n − 1) t / (n R²)): at t = 15 mm f is 13.33 mm, at 25 mm 120 / 7 = 17.14 mm.
TEST(CheckerValues, AThickLensHasAShortPetzvalRadius) {
    optics::Prescription thick;
    thick.surfaces.resize(3);
    thick.surfaces[0] = {.radius_mm = 10.0, .thickness_mm = 15.0, .semi_diameter_mm = 4.0, .medium = {.n_d = 1.5}};
    thick.surfaces[1] = {.radius_mm = -10.0, .thickness_mm = 1.0, .semi_diameter_mm = 4.0};
    thick.surfaces[2] = {.semi_diameter_mm = 0.5, .is_stop = true};
    expect_planted(thick, [](P& p) { p.surfaces[0].thickness_mm = 25.0; },
                   {"petzval-radius", optics::Severity::warning, 0, -15.0, 1e-9, 120.0 / 7.0});
}

// An afocal pair: the first surface focuses 3 R = 30 mm behind itself, the second collimates g − 30 mm behind that.
// What is left of either ray's slope there is 1 / g of it, so rounding weighs g / R times as much: 2e-16 · 1e8.
TEST(CheckerValues, TheLagrangeInvariantIsLostWhereNumbersAreTooFarApart) {
    optics::Prescription afocal;
    afocal.surfaces.resize(3);
    afocal.surfaces[0] = {.radius_mm = 10.0, .semi_diameter_mm = 1.0, .medium = {.n_d = 1.5}};
    afocal.surfaces[1] = {.thickness_mm = 1.0, .semi_diameter_mm = 1.0};
    afocal.surfaces[2] = {.semi_diameter_mm = 1.0, .is_stop = true};
    const auto lengthen = [](P& p, double gap) {
        p.surfaces[0].thickness_mm = gap;
        p.surfaces[1].radius_mm = -(gap - 30.0) / 3.0;
    };
    lengthen(afocal, 100.0);
    expect_planted(afocal, [&](P& p) { lengthen(p, 1e9); },
                   {"lagrange-invariant", optics::Severity::error, 2, 0.0, 1e-7, 1e-12});
}

// The Tessar's rear surface made hollow: its rim reaches 20 − √(20² − 16.5²) = 8.697 mm behind its vertex.
TEST(CheckerValues, TheRimReachesPastASensorTooNear) {
    optics::Prescription hollow = tessar();
    hollow.surfaces[7].radius_mm = 20.0;
    expect_planted(hollow, [](P& p) { p.surfaces[7].thickness_mm = 3.0; },
                   {"sensor-inside-lens", optics::Severity::error, 8, 3.0 - sphere_sag(20.0, 16.5)});
}

// A plate of 1.4 mm and n = 1.5168 sets the image back by (1 − 1/n) t = 0.477 mm (Born & Wolf 4.4); in the table, it
// makes the same lens meet the same distance.
TEST(CheckerValues, ABackFocusTooLongByAThirdOfAPlateIsACoverGlass) {
    constexpr double kPlate = 1.4;
    constexpr double kIndex = 1.5168;
    const auto further = [](double millimetres) {
        optics::Prescription lens = half_ball();
        lens.stated.efl_mm = 20.0;
        lens.surfaces.back().thickness_mm += millimetres;
        return lens;
    };
    const double set_back = (1.0 - 1.0 / kIndex) * kPlate;
    const CheckReport left_out = checked(further(set_back));
    const optics::Finding* finding = find(left_out, "back-focus");
    ASSERT_NE(finding, nullptr) << said(left_out);
    EXPECT_EQ(finding->severity, optics::Severity::info);
    EXPECT_TRUE(says(finding->message, "a cover glass of 1.4 mm would explain it")) << finding->message;

    optics::Prescription listed = further(set_back);
    listed.surfaces.back().thickness_mm -= 5.0 + kPlate;
    listed.surfaces.push_back({.thickness_mm = kPlate, .semi_diameter_mm = 9.0, .medium = {.n_d = kIndex}});
    listed.surfaces.push_back({.thickness_mm = 5.0, .semi_diameter_mm = 9.0});
    EXPECT_EQ(find(checked(listed), "back-focus"), nullptr) << said(checked(listed));

    // A guess where no focal length says that the lens is as meant; no word where it is not, where the sensor stands
    // too near, or where no sensor's glass is so thick.
    optics::Prescription unclaimed = further(set_back);
    unclaimed.stated = {};
    ASSERT_NE(find(checked(unclaimed), "back-focus"), nullptr);
    EXPECT_EQ(find(checked(unclaimed), "back-focus")->severity, optics::Severity::warning);
    EXPECT_TRUE(says(find(checked(unclaimed), "back-focus")->message, "cover glass"));
    optics::Prescription misstated = further(set_back);
    misstated.stated.efl_mm = 20.5;
    for (const optics::Prescription& lens : {misstated, further(-set_back), further(4.0 * set_back)}) {
        const CheckReport report = checked(lens);
        ASSERT_NE(find(report, "back-focus"), nullptr);
        EXPECT_EQ(find(report, "back-focus")->severity, optics::Severity::error) << said(report);
        EXPECT_FALSE(says(find(report, "back-focus")->message, "cover glass"));
    }

    // Both are named, and it is no less of an error, where a slip explains it as well: 20.5 read for 20.05, or what
    // leaves the focal length 0.3 % off.
    optics::Prescription swapped = further(0.5);
    swapped.surfaces.back().thickness_mm = 20.5;
    swapped.surfaces[1].radius_mm = -10.025;  // f = 20.05 mm
    swapped.stated.efl_mm = 20.05;
    optics::Prescription nearly = further(set_back);
    nearly.stated.efl_mm = 20.06;
    for (const optics::Prescription& lens : {swapped, nearly}) {
        const CheckReport report = checked(lens);
        ASSERT_NE(find(report, "back-focus"), nullptr);
        EXPECT_EQ(find(report, "back-focus")->severity, optics::Severity::error) << said(report);
        EXPECT_TRUE(says(find(report, "back-focus")->message, "mm would explain it, and so would a slip"));
    }
}

// The Tessar's thicknesses add up to 119.451 mm.
TEST(CheckerValues, TheTrackIsTheSumOfTheThicknesses) {
    optics::Prescription lens = tessar();
    lens.stated.total_track_mm = 119.451;
    expect_planted(lens, [](P& p) { p.stated.total_track_mm = 121.0; },
                   {"total-track", optics::Severity::warning, 0, 100.0 * (121.0 - 119.451) / 121.0});
}

// With its signs turned the half ball has f = −20 mm, 40 mm from the 20 mm claimed: 200 %. Turned round, its focal
// length is the same, but the focus comes t / n = 6.667 mm nearer: a third.
TEST(CheckerValues, AReversedTableWouldMeetItsClaims) {
    optics::Prescription lens = half_ball();
    lens.stated.efl_mm = 20.0;
    lens.stated.bfl_mm = 20.0;
    expect_planted(lens, [](P& p) { p.surfaces[1].radius_mm = 10.0; },
                   {"reversed", optics::Severity::warning, 0, 200.0});
    const auto turn_round = [](P& p) {
        std::swap(p.surfaces[0].semi_diameter_mm, p.surfaces[1].semi_diameter_mm);
        std::swap(p.surfaces[0].is_stop, p.surfaces[1].is_stop);
        p.surfaces[0].radius_mm = 10.0;
        p.surfaces[1].radius_mm = INFINITY;
    };
    expect_planted(lens, turn_round, {"reversed", optics::Severity::warning, 0, 100.0 / 3.0});
}

TEST(CheckerValues, OtherSpellingsAndGlassesNoLongerMadeAreNamed) {
    optics::Prescription lens = half_ball();
    lens.surfaces[0].medium = {.glass = "N-BK7"};
    expect_planted(lens, [](P& p) { p.surfaces[0].medium.glass = "N BK 7"; },
                   {"glass-spelling", optics::Severity::info, 1});
    expect_planted(lens, [](P& p) { p.surfaces[0].medium.glass = "BK7"; },
                   {"glass-obsolete", optics::Severity::info, 1});
}

// The render's first wavelength that the table does not reach is 400 nm.
TEST(CheckerValues, AShortTableOfIndicesIsNamedByItsFirstGap) {
    optics::Prescription lens = half_ball();
    const std::vector<optics::WavelengthValue> whole = {{400, 1.51}, {587.5618, 1.5}, {700, 1.495}};
    lens.surfaces[0].medium = {.indices = whole};
    expect_planted(lens, [](P& p) { p.surfaces[0].medium.indices[0].wavelength_nm = 450; },
                   {"wavelength-range", optics::Severity::warning, 1, 400.0, 0.0, 450.0});
}

TEST(CheckerValues, NothingIsComputedWhereAGlassHasNoIndex) {
    const optics::GlassCatalogue& glasses = formats::shipped_glasses();
    const optics::Prescription lens = tessar();
    CheckSettings settings{.wavelength_nm = 200.0, .indices = {}, .zoom_position = {}};
    const CheckReport report = check_prescription(lens, {}, glasses, settings);
    const optics::Finding* range = find(report, "wavelength-range");
    ASSERT_NE(range, nullptr);
    EXPECT_EQ(range->severity, optics::Severity::error);
    EXPECT_EQ(range->value, 200.0);
    EXPECT_GT(range->limit, 200.0);
    EXPECT_TRUE(says(range->message, lens.surfaces[range->surface - 1].medium.glass));
    EXPECT_TRUE(report.computed.empty());
    EXPECT_EQ(find(report, "focal-length"), nullptr);
    EXPECT_EQ(find(report, "back-focus"), nullptr);
    EXPECT_NE(find(report, "not-judged"), nullptr);

    // An index in place of each glass holds at 200 nm, too: the lens is what it is at d with them.
    for (const optics::PrescribedSurface& row : lens.surfaces) {
        if (!row.medium.is_air()) {
            settings.indices[row.medium.glass] = 1.6;
        }
    }
    const CheckReport overridden = check_prescription(lens, {}, glasses, settings);
    EXPECT_EQ(find(overridden, "wavelength-range"), nullptr) << said(overridden);
    settings.wavelength_nm = spectral::kLineD;
    ASSERT_EQ(overridden.computed.size(), 1U);
    EXPECT_EQ(overridden.computed[0].paraxial.efl,
              check_prescription(lens, {}, glasses, settings).computed.at(0).paraxial.efl);
}

// SCHOTT, HOYA and others have an F2, each with a formula of its own; a maker's name says which is meant.
TEST(CheckerValues, ANameOfSeveralMakersIsNoted) {
    optics::Prescription lens = half_ball();
    lens.surfaces[0].medium = {};
    lens.surfaces[0].medium.glass = "SCHOTT F2";
    expect_planted(lens, [](P& p) { p.surfaces[0].medium.glass = "F2"; },
                   {"glass-ambiguous", optics::Severity::info, 1});
    lens.surfaces[0].medium.glass = "F2";
    const CheckReport report = checked(lens);
    const std::string& message = find(report, "glass-ambiguous")->message;
    EXPECT_TRUE(says(message, "taken for that of SCHOTT"));
    EXPECT_TRUE(says(message, "HOYA"));
}

TEST(CheckerValues, TheModelledDispersionsErrorIsStatedUpToItsEnds) {
    optics::Prescription lens = half_ball();
    lens.surfaces[0].medium.V_d = 60.0;
    CheckReport report = checked(lens);
    ASSERT_NE(find(report, "normal-line"), nullptr);
    const std::string one = find(report, "normal-line")->message;
    for (const char* wavelength : {" at 365 nm", " at 400 nm", " at 700 nm", " at 1014 nm"}) {
        EXPECT_TRUE(says(one, wavelength));
    }
    EXPECT_TRUE(one.starts_with("given by n_d and V_d alone: its dispersion")) << one;

    optics::Prescription two = ball(9.0);
    two.surfaces[0].medium.V_d = two.surfaces[1].medium.V_d = 60.0;
    report = checked(two);
    ASSERT_NE(find(report, "normal-line"), nullptr);
    EXPECT_TRUE(says(find(report, "normal-line")->message, "the worst of 2 such glasses"));
}

TEST(CheckerValues, ARowTypedTwiceAndATableWithoutRows) {
    expect_planted(half_ball(), [](P& p) { p.surfaces.push_back(p.surfaces[1]); },
                   {"duplicate-surface", optics::Severity::warning, 3});
    expect_planted(half_ball(), [](P& p) { p.surfaces.clear(); }, {"no-surface", optics::Severity::error, 0});
}

}  // namespace lensproof::check::checker_values_test
