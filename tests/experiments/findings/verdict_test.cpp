#include "experiments/findings/verdict.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/profile/curve_difference.h"

namespace lensproof::findings::verdict_test {

Check check(double value, double sigma, double limit, Expectation expectation, double target = 0.0) {
    Check made;
    made.value = value;
    made.sigma = sigma;
    made.limit = limit;
    made.expectation = expectation;
    made.target = target;
    return made;
}

// The 95 % interval is value ± 1.96 σ: whole below the limit, whole above it, or astride.
TEST(Verdict, LooksAtTheWholeInterval) {
    EXPECT_EQ(check(0.03, 0.01, 0.05, Expectation::at_most).verdict(), Verdict::pass);
    EXPECT_EQ(check(0.03, 0.02, 0.05, Expectation::at_most).verdict(), Verdict::inconclusive);
    EXPECT_EQ(check(0.08, 0.02, 0.05, Expectation::at_most).verdict(), Verdict::inconclusive);
    EXPECT_EQ(check(0.10, 0.02, 0.05, Expectation::at_most).verdict(), Verdict::fail);
    EXPECT_EQ(check(0.05, 0.0, 0.05, Expectation::at_most).verdict(), Verdict::pass);
}

TEST(Verdict, WithinIsAboutTheTarget) {
    EXPECT_EQ(check(533.0, 0.4, 2.1, Expectation::within, 533.3).verdict(), Verdict::pass);
    EXPECT_EQ(check(530.0, 0.4, 2.1, Expectation::within, 533.3).verdict(), Verdict::fail);
}

// A difference is judged: the value, or how far it is from its target. What is not known is no floor.
TEST(Verdict, ADifferenceMayBeBelowTheMethodsOwnError) {
    Check difference = check(0.004, 0.001, 0.05, Expectation::at_most);
    EXPECT_FALSE(difference.is_below_floor());
    difference.floor = 0.005;
    EXPECT_TRUE(difference.is_below_floor());
    difference.floor = 0.003;
    EXPECT_FALSE(difference.is_below_floor());
    Check focal = check(533.0, 0.4, 2.1, Expectation::within, 533.3);
    focal.floor = 0.2;
    EXPECT_FALSE(focal.is_below_floor());
    focal.floor = 0.4;
    EXPECT_TRUE(focal.is_below_floor());
}

TEST(Verdict, NegativeControlsWantADifference) {
    EXPECT_EQ(check(5.0, 0.1, 1.0, Expectation::differs).verdict(), Verdict::pass);
    EXPECT_EQ(check(0.5, 0.1, 1.0, Expectation::differs).verdict(), Verdict::fail);
    EXPECT_EQ(check(1.1, 0.1, 1.0, Expectation::differs).verdict(), Verdict::inconclusive);
    EXPECT_EQ(check(5.0, 0.1, 1.0, Expectation::at_least).verdict(), Verdict::pass);
    EXPECT_EQ(check(0.5, 0.1, 1.0, Expectation::at_least).verdict(), Verdict::fail);
}

TEST(Verdict, WhatIsNotKnownIsNotPassed) {
    EXPECT_EQ(check(NAN, 0.1, 1.0, Expectation::at_most).verdict(), Verdict::inconclusive);
    EXPECT_EQ(overall({check(0.1, 0, 1, Expectation::at_most), check(NAN, 0, 1, Expectation::at_most)}),
              Verdict::inconclusive);
    EXPECT_EQ(overall({check(2.0, 0, 1, Expectation::at_most), check(NAN, 0, 1, Expectation::at_most)}), Verdict::fail);
    EXPECT_EQ(overall({}), Verdict::pass);
}

calibration::Curve curve(double (*f)(double), double sigma, double covered) {
    calibration::Curve made;
    for (const double x : calibration::standard_image_heights()) {
        calibration::append(made, x, {f(x), f(x) - calibration::k95 * sigma, f(x) + calibration::k95 * sigma});
    }
    made.covered_image_height = covered;
    return made;
}

// a − b = x over [0, 0.8]: the area-weighted rms of x is √(∫x³ / ∫x) = 0.8 / √2, up to the sum's step of 1/40; the
// uncertainties 0.3 and 0.4 add to 0.5.
TEST(CurveDifference, WeighsByAreaAndAddsUncertaintiesInQuadrature) {
    const auto d = calibration::difference(curve([](double x) { return 3.0 + x; }, 0.3, 0.9),
                                           curve([](double) { return 3.0; }, 0.4, 0.8));
    ASSERT_TRUE(d);
    EXPECT_NEAR(d->rms, 0.8 / std::sqrt(2.0), 0.02);
    EXPECT_NEAR(d->rms_sigma, 0.5, 1e-12);
    EXPECT_NEAR(d->largest, 0.8, 1e-12);
    EXPECT_NEAR(d->largest_at, 0.8, 1e-12);
    EXPECT_NEAR(d->curve.covered_image_height, 0.8, 1e-12);
}

// Two cameras with focal lengths of 1000 and 1010 px image the direction θ at radii 10 tan θ px apart; at equal heights
// of up to 400 px (θ ≤ 22°), first order in the 1 % difference leaves 1 % of it.
TEST(CurveDifference, AnglesTurnIntoPixels) {
    calibration::Profile a;
    a.width_px = 640;
    a.height_px = 480;
    calibration::Profile b = a;
    for (const double x : calibration::standard_image_heights()) {
        const auto angle = [&](double focal) { return std::atan(400.0 * x / focal) * 180.0 / M_PI; };
        calibration::append(a.curves["field_angle_deg"], x, {angle(1010), angle(1010), angle(1010)});
        calibration::append(b.curves["field_angle_deg"], x, {angle(1000), angle(1000), angle(1000)});
    }
    a.curves["field_angle_deg"].covered_image_height = 1.0;
    b.curves["field_angle_deg"].covered_image_height = 1.0;
    const auto d = calibration::radial_difference_px(a, b);
    ASSERT_TRUE(d);
    EXPECT_NEAR(d->largest, 10.0 * 400.0 / 1000.0, 0.1);
    EXPECT_GT(d->curve.value[20], 0.0);
}

}  // namespace lensproof::findings::verdict_test
