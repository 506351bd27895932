// Findings of real rays, in lenses simple enough for their rays to be followed by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/angle.h"
#include "engine/formats/prescription/prescription_file.h"
#include "tests/complaint.h"
#include "tests/engine/check/checker_case.h"

namespace lensproof::check::checker_rays_test {

using P = optics::Prescription;

optics::Prescription at_field(optics::Prescription lens, double half_field_deg) {
    lens.stated.half_field_deg = half_field_deg;
    return lens;
}

/// Plants the field.
std::function<void(optics::Prescription&)> field(double half_field_deg) {
    return [=](optics::Prescription& lens) { lens.stated.half_field_deg = half_field_deg; };
}

// A ray at height h meets the half ball's rear at i = asin(h / R), leaves at asin(n h / R) from the normal, so at the
// difference δ of the two from the axis: f/0.5/sin δ, where paraxially f / 2h = f/2.5.
TEST(CheckerRays, TheHalfBallsRealFNumber) {
    const double delta = std::asin(1.5 * 0.4) - std::asin(0.4);
    expect_planted(half_ball(1.0), [](P& p) { p.surfaces[0].semi_diameter_mm = 4.0; },
                   {"real-f-number", optics::Severity::info, 0, 0.5 / std::sin(delta), 1e-9, 2.5});
}

/// Set to an object 40 mm in front of its flat face.
optics::Prescription near_half_ball(double stop_semi_diameter) {
    optics::Prescription lens = half_ball(stop_semi_diameter);
    lens.object_distance_mm = 40.0;
    return lens;
}

// From 40 mm, the paraxial ray through height a of the front arrives with the slope a / 40, runs with a / 60 in the
// glass to the height 7a / 6, and leaves with a / 40 − 0.05 · 7a / 6 = −a / 30: f/15/a, not the f/10/a of far objects.
// The real one has the angle u' = asin(sin u / n) in the glass and passes the centre at a cos u'; it meets the sphere
// at i = asin(a cos u' / R) and is turned by asin(n sin i) − i.
TEST(CheckerRays, ANearObjectsFNumbersAreTheWorkingOnes) {
    constexpr double kHeight = 4.0;
    const double inside = std::asin(std::sin(std::atan(kHeight / 40.0)) / 1.5);
    const double incidence = std::asin(0.1 * kHeight * std::cos(inside));
    const double outside = std::asin(1.5 * std::sin(incidence)) - incidence - inside;
    expect_planted(near_half_ball(1.0), [=](P& p) { p.surfaces[0].semi_diameter_mm = kHeight; },
                   {"real-f-number", optics::Severity::info, 0, 0.5 / std::sin(outside), 1e-9, 15.0 / kHeight});
}

TEST(CheckerRays, ANearObjectsBeamIsHeldAgainstTheStopsFromThere) {
    const optics::Prescription good = near_half_ball(3.0);
    EXPECT_EQ(find(checked(good), "marginal-ray"), nullptr);
    const auto narrow_the_rear = [](P& p) { p.surfaces[1].semi_diameter_mm = 3.0; };
    expect_planted(good, narrow_the_rear, {"stop-not-limiting", optics::Severity::warning, 2, kNaN, 0.0, 3.0});
    optics::Prescription narrowed = good;
    narrow_the_rear(narrowed);
    const CheckReport report = checked(narrowed);
    EXPECT_TRUE(says(find(report, "stop-not-limiting")->message, "f/5.00 by the stop")) << said(report);
}

// The rear's rim reaches 20 − √(20² − 6²) = 0.92 mm behind its vertex, past the stop's plane 0.3 mm behind it. No ray
// bends in that plane, so none is stopped there.
TEST(CheckerRays, AStopInsideASurfacesSagTurnsNoRayBack) {
    optics::Prescription lens;
    lens.surfaces.resize(3);
    lens.surfaces[0] = {.radius_mm = 15.0, .thickness_mm = 3.0, .semi_diameter_mm = 7.0, .medium = {.n_d = 1.5}};
    lens.surfaces[1] = {.radius_mm = 20.0, .thickness_mm = 2.0, .semi_diameter_mm = 7.0};
    lens.surfaces[2] = {.thickness_mm = 0.0, .semi_diameter_mm = 6.0, .is_stop = true};
    const auto close_up = [](P& p) { p.surfaces[1].thickness_mm = 0.3; };
    expect_planted(at_field(lens, 10.0), close_up, {"surfaces-cross", optics::Severity::info, 2});
    optics::Prescription closed_up = at_field(lens, 10.0);
    close_up(closed_up);
    const CheckReport report = checked(closed_up);
    EXPECT_EQ(find(report, "order-of-surfaces"), nullptr) << said(report);
    EXPECT_EQ(find(report, "marginal-ray"), nullptr) << said(report);
    EXPECT_TRUE(report.ok()) << said(report);
}

// Where the stop is a glass surface, its own total reflection ends the field: at 90° in air.
TEST(CheckerRays, AStopOnGlassEndsTheFieldWhereItReflectsTotally) {
    expect_planted(at_field(half_ball(), 55.0), field(95.0),
                   {"chief-ray", optics::Severity::error, 1, 90.0, 1e-3, 95.0});
}

// By the law of sines that ray crosses the axis n h / sin δ behind the ball's centre. Over the pupil, the rms of its
// height y + t z in the plane z of least rms is computed here in 100 times as many zones as in the checker. The
// midpoint rule in N = 32 zones makes ∫x⁷, ∫x⁵, ∫x³ too small by (7, 5, 3) / 24 N², which takes 60 / 24 N² = 0.24 %
// from the rms of third-order aberration, B a³ / 6, and somewhat more from this lens's, which is of higher orders too.
TEST(CheckerRays, TheHalfBallsBlur) {
    constexpr double kRadius = 4.0;
    constexpr int kZones = 3200;
    double tt = 0.0;
    double yt = 0.0;
    double yy = 0.0;
    double weights = 0.0;
    for (int k = 0; k < kZones; ++k) {
        const double h = kRadius * (k + 0.5) / kZones;
        const double delta = std::asin(0.15 * h) - std::asin(0.1 * h);
        const double t = -std::tan(delta);
        const double y = -t * 1.5 * h / std::sin(delta);  // in the plane of the ball's centre
        tt += h * t * t;
        yt += h * y * t;
        yy += h * y * y;
        weights += h;
    }
    const double blur = std::sqrt((yy - yt * yt / tt) / weights);
    expect_planted(half_ball(1.0), [=](P& p) { p.surfaces[0].semi_diameter_mm = kRadius; },
                   {"blur", optics::Severity::info, 0, 100.0 * blur / 20.0, 0.005 * 100.0 * blur / 20.0, 0.08});
}

// Of a single element f_F − f_C = −f (n_F − n_C)(n_d − 1) / ((n_F − 1)(n_C − 1)), which is −f / V but for terms of
// relative order 1 / V.
TEST(CheckerRays, ASingleElementsColourIsOneOverV) {
    optics::Prescription lens = half_ball();
    lens.surfaces[0].medium.V_d = 80.0;
    expect_planted(lens, [](P& p) { p.surfaces[0].medium.V_d = 60.0; },
                   {"axial-colour", optics::Severity::info, 0, -100.0 / 60.0, 100.0 / 60.0 / 60.0, 1.5});
}

// Rays meet the flat front at the field's angle, and the rear, which is concentric with the stop, nearly at none.
TEST(CheckerRays, AFlatFrontIsMetAtTheFieldsAngle) {
    expect_planted(at_field(half_ball(), 55.0), field(65.0),
                   {"incidence-angle", optics::Severity::info, 1, 65.0, 1e-6, 60.0});
    expect_planted(at_field(half_ball(), 55.0), field(82.0),
                   {"incidence-angle", optics::Severity::warning, 1, 82.0, 1e-6, 80.0});
}

// A hole in the front surface looks narrower by cos θ. It is counted in cells of a sixtieth of its radius, of which it
// cuts some hundreds; half of them are counted, so no more than one part in fifty is off.
TEST(CheckerRays, AStopInFrontVignettesWithTheCosine) {
    const double open_percent = 100.0 * std::cos(80.0 * kDegree);
    expect_planted(at_field(half_ball(), 65.0), field(80.0),
                   {"vignetting", optics::Severity::warning, 0, open_percent, 0.02 * open_percent, 20.0});
}

// The chief ray leaves the front at asin(sin θ / n) and goes straight on to the sensor, f + R = 30 mm behind.
TEST(CheckerRays, TheHalfBallsDistortion) {
    const double height = 30.0 * std::tan(std::asin(0.5 / 1.5));
    const double off = height / (20.0 * std::tan(30.0 * kDegree)) - 1.0;
    expect_planted(at_field(half_ball(), 20.0), field(30.0),
                   {"distortion", optics::Severity::warning, 0, 100.0 * off, 1e-6, 5.0});
}

// The ball images as f tan θ: against a fisheye's f θ, that is off by tan θ / θ − 1.
TEST(CheckerRays, AFisheyeIsHeldToItsOwnProjection) {
    const double theta = 30.0 * kDegree;
    expect_planted(at_field(ball(9.0), 30.0), [](P& p) { p.projection = optics::Projection::equidistant; },
                   {"distortion", optics::Severity::warning, 0, 100.0 * (std::tan(theta) / theta - 1.0), 1e-6, 10.0});
}

TEST(CheckerRays, NoRectilinearLensSeesAHalfFieldBeyondEightyDegrees) {
    expect_planted(at_field(ball(9.9), 70.0), field(81.0),
                   {"distortion", optics::Severity::warning, 0, 81.0, 1e-9, 80.0});
}

// 2 f tan θ; and where no field is claimed, up to the chief ray that meets the sphere at its rim: sin θ = 5 / 10.
TEST(CheckerRays, TheBallsImageCircle) {
    optics::Prescription lens = at_field(ball(9.0), 20.0);
    const double circle = 30.0 * std::tan(20.0 * kDegree);
    lens.stated.image_circle_mm = circle;
    const auto claim = [](P& p) { p.stated.image_circle_mm = 24.0; };
    expect_planted(lens, claim, {"image-circle", optics::Severity::warning, 0, circle, 1e-6, 24.0});

    optics::Prescription rimmed = ball(5.0);
    rimmed.stated.image_circle_mm = 17.0;
    expect_planted(rimmed, claim,
                   {"image-circle", optics::Severity::warning, 0, 30.0 * std::tan(30.0 * kDegree), 1e-6, 24.0});
}

// Plano-convex, R = 20, 1 mm thick: from √(1 · (2 · 20 − 1)) = 6.24 mm on, its flat rear lies in front of its front.
// The stop, 5 mm behind, takes the field of 40° from 7 mm: every ray of it.
TEST(CheckerRays, SurfacesInTheWrongOrderAtTheField) {
    optics::Prescription lens;
    lens.surfaces.resize(3);
    lens.surfaces[0] = {.radius_mm = 20.0, .thickness_mm = 4.0, .semi_diameter_mm = 11.0, .medium = {.n_d = 1.5}};
    lens.surfaces[1] = {.thickness_mm = 5.0, .semi_diameter_mm = 11.0};
    lens.surfaces[2] = {.thickness_mm = 0.0, .semi_diameter_mm = 0.3, .is_stop = true};
    expect_planted(at_field(lens, 40.0), [](P& p) { p.surfaces[0].thickness_mm = 1.0; },
                   {"order-of-surfaces", optics::Severity::error, 2, 100.0, 1e-9, 1.0});
}

TEST(CheckerRays, WhatIsNotAskedOfTiltedAndToroidalLensesIsSaid) {
    const optics::Prescription good = at_field(formats::read_prescription(formats::find_lens_file("tessar")), 24.0);
    const Expected expected{"not-judged", optics::Severity::info, 0};
    expect_planted(
        good, [](P& p) { p.surfaces[0].misalignment.tilt_deg[1] = 0.1; }, expected);
    expect_planted(
        good, [](P& p) { p.surfaces[0].radius_x_mm = 43.0; }, expected);
    expect_planted(
        good,
        [](P& p) {
            p.groups = {{.first = 5, .last = 6, .misalignment = {.decentre_mm = {0.1, 0.0}}}};
        },
        expected);
    // A rim in the field's light is named in the centred lens only.
    optics::Prescription clipped = good;
    clipped.surfaces[7].semi_diameter_mm = 10.0;
    EXPECT_NE(find(checked(clipped), "chief-ray"), nullptr);
    clipped.surfaces[0].misalignment.tilt_deg[1] = 0.1;
    const CheckReport report = checked(clipped);
    EXPECT_EQ(find(report, "chief-ray"), nullptr);
    ASSERT_NE(find(report, "not-judged"), nullptr);
    EXPECT_TRUE(says(find(report, "not-judged")->message, "tilted, shifted, toroidal or ruled"));
}

TEST(CheckerRays, WhatIsNotAskedOfAFiniteObjectsFieldIsSaid) {
    const optics::Prescription good = at_field(half_ball(), 20.0);
    const auto come_near = [](P& p) { p.object_distance_mm = 1000.0; };
    expect_planted(good, come_near, {"not-judged", optics::Severity::info, 0});
    optics::Prescription unclaimed = half_ball();
    come_near(unclaimed);
    EXPECT_EQ(find(checked(unclaimed), "not-judged"), nullptr) << "nothing is claimed that rays could judge";
}

// The Tessar without its semi-diameters: estimated rims let rays pass that no real rim would, which the table never
// said.
TEST(OrderOfSurfaces, IsNoErrorWhereTheRimsAreEstimated) {
    optics::Prescription lens = formats::read_prescription(formats::find_lens_file("tessar"));
    for (optics::PrescribedSurface& row : lens.surfaces) {
        row.semi_diameter_mm.reset();
    }
    const CheckReport report = checked(lens);
    const optics::Finding* found = find(report, "order-of-surfaces");
    ASSERT_NE(found, nullptr) << said(report);
    EXPECT_EQ(found->severity, optics::Severity::warning);
    EXPECT_TRUE(report.ok()) << said(report);
}

// A half ball with its flat side in front at f/3.3 has its marginal focus some 2 mm before the paraxial one at 20 mm
// (third order: 4.5 y² / f), and its real rays are sharpest a little behind the middle of the two, or of higher orders
// further in front: who puts the sensor there means it. Elsewhere, and beyond the paraxial focus, it is a slip.
TEST(CheckerRays, ABestFocusIsNoWrongBackFocus) {
    optics::Prescription lens = half_ball(3.0);
    std::vector<double> meant_mm;
    for (double mm = 16.0; mm < 19.7; mm += 0.05) {
        lens.surfaces[1].thickness_mm = mm;
        const CheckReport report = checked(lens);
        const optics::Finding* found = find(report, "back-focus", 2);
        ASSERT_NE(found, nullptr) << said(report);
        const bool is_at_edge = std::abs(mm - 17.886) < 0.05;  // where the beam's edge crosses the axis
        if (found->severity == optics::Severity::info && !is_at_edge) {
            meant_mm.push_back(mm);
        }
    }
    ASSERT_FALSE(meant_mm.empty());
    EXPECT_GT(meant_mm.front(), 17.5);
    EXPECT_LT(meant_mm.back(), 19.0);
    EXPECT_LT(meant_mm.back() - meant_mm.front(), 0.2 * (20.0 - meant_mm.front()) + 0.05) << "a tenth to either side";
    lens.surfaces[1].thickness_mm = 21.0;
    const CheckReport beyond = checked(lens);
    const optics::Finding* wrong = find(beyond, "back-focus", 2);
    ASSERT_NE(wrong, nullptr) << said(beyond);
    EXPECT_EQ(wrong->severity, optics::Severity::error) << wrong->message;
}

// A diverging lens of a catalogue: its file puts the image plane where the virtual image is. Elsewhere in front of the
// lens it is a slip.
TEST(CheckerRays, ADivergingLensMayHaveItsVirtualImage) {
    optics::Prescription lens = half_ball();
    lens.surfaces[1].radius_mm = 10.0;
    lens.surfaces[1].thickness_mm = -20.0;
    const CheckReport meant = checked(lens);
    EXPECT_TRUE(meant.ok()) << said(meant);
    const optics::Finding* image = find(meant, "virtual-image", 2);
    ASSERT_NE(image, nullptr) << said(meant);
    EXPECT_NEAR(image->value, -20.0, 1e-9);
    lens.surfaces[1].thickness_mm = -15.0;
    const CheckReport slip = checked(lens);
    EXPECT_NE(find(slip, "negative-thickness", 2), nullptr) << said(slip);
    EXPECT_NE(find(slip, "negative-power"), nullptr) << said(slip);
}

}  // namespace lensproof::check::checker_rays_test
