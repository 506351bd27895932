// tests/experiments/studies/tradeoff/rungs_test.cpp — models set against each other: the front, equal times, and which
// suffices.
#include "experiments/studies/tradeoff/rungs.h"

#include <gtest/gtest.h>

#include "experiments/studies/tradeoff/sufficient_rung.h"

namespace lensproof::studies::rungs_test {

MeasuredRung rung(const std::string& name, double seconds, double px, double ciede2000) {
    MeasuredRung made{.name = name};
    made.samples = 64;
    made.cost = {.samples = 100.0, .seconds = seconds};
    made.field.frame.image_px = {px, 0.01};
    made.picture.ciede2000 = {.bias = {ciede2000, 0.05}, .noise = 0.0};
    return made;
}

// Two pictures of 64 samples differ by a noise of 0.8: each has 0.8/√2. In the time of the reference, four times the
// 100 s in which the model takes 100 samples, it takes 400, and its noise is √(64/400) of that.
TEST(Rungs, AtEqualTimeACheaperModelHasLessNoise) {
    std::vector<MeasuredRung> rungs = {rung("pinhole", 100.0, 5.0, 0.3), rung(kReferenceRung, 400.0, 0.0, 0.0)};
    rungs[0].picture.ciede2000.noise = 0.8;
    rungs[0].picture.flip = {.bias = {0.01, 0.001}, .noise = 0.08};
    compare_rungs(rungs);
    const double fraction = std::sqrt(0.5 * 64.0 / 400.0);
    EXPECT_NEAR(rungs[0].ciede2000_at_equal_time, std::hypot(0.3, 0.8 * fraction), 1e-12);
    EXPECT_NEAR(rungs[0].flip_at_equal_time, std::hypot(0.01, 0.08 * fraction), 1e-12);
    EXPECT_EQ(rungs[1].flip_at_equal_time, 0.0);
}

TEST(Rungs, TheCheapestThatKeepsTheToleranceSuffices) {
    std::vector<MeasuredRung> rungs = {rung("pinhole", 100.0, 5.0, 0.3), rung("thin-lens", 150.0, 3.0, 0.2),
                                       rung("paraxial", 300.0, 0.2, 0.4), rung("polynomial", 200.0, 0.6, 0.8),
                                       rung(kReferenceRung, 400.0, 0.0, 0.0)};
    const Tolerance tolerance = parse_tolerance("1px,0.03ev,1de");
    const SufficientRung found = sufficient_rung(rungs, tolerance);
    EXPECT_EQ(found.rung.name, "polynomial");
    EXPECT_TRUE(found.is_sure);
    EXPECT_DOUBLE_EQ(found.speed_up, 2.0);
    EXPECT_EQ(largest_error(found.rung, tolerance), "0.8 ± 0.05 CIEDE2000");
    ASSERT_TRUE(found.cheaper);
    EXPECT_EQ(found.cheaper->name, "thin-lens");  // 3 px are less off than the pinhole's 5
    EXPECT_EQ(largest_error(*found.cheaper, tolerance), "3 ± 0.01 px off");
    // An error that two standard errors carry over the tolerance is kept as far as one knows.
    rungs[3].picture.ciede2000.bias.standard_error = 0.2;
    EXPECT_EQ(sufficient_rung(rungs, tolerance).rung.name, "polynomial");
    EXPECT_FALSE(sufficient_rung(rungs, tolerance).is_sure);
    // Nor is it sure where the reference seems to differ from itself by as much.
    rungs[3].picture.ciede2000.bias.standard_error = 0.05;
    rungs[4].picture.ciede2000.bias.value = 0.2;
    EXPECT_FALSE(sufficient_rung(rungs, tolerance).is_sure);
}

// The reference is what others are held against: its pictures' noise is no error.
TEST(Rungs, WhereNoModelSufficesTheReferenceDoes) {
    const std::vector<MeasuredRung> rungs = {rung("pinhole", 100.0, 5.0, 0.3), rung(kReferenceRung, 400.0, 0.0, 2.0)};
    const SufficientRung found = sufficient_rung(rungs, parse_tolerance("1px,0.03ev,1de"));
    EXPECT_EQ(found.rung.name, kReferenceRung);
    EXPECT_TRUE(found.is_sure);
    EXPECT_EQ(found.speed_up, 1.0);
}

// A width may be wrong where a place is not: what a tolerance asks is the larger of the two.
TEST(Rungs, AWidthCountsAsAPlaceDoes) {
    MeasuredRung wide = rung("pinhole", 100.0, 0.1, 0.0);
    wide.field.frame.blur_px = {2.0, 0.1};
    EXPECT_EQ(asked_of(wide).px.value, 2.0);
    EXPECT_EQ(largest_error(wide, parse_tolerance("1px")), "2 ± 0.1 px of width");
}

}  // namespace lensproof::studies::rungs_test
