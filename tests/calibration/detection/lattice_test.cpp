#include <gtest/gtest.h>

#include "tests/calibration/shot.h"

namespace lensproof::calibration::lattice_test {

using namespace synthetic;

const scene::Chart kDiscs{.pattern = scene::DiscGrid{9, 7, 30.0, 15.0}};
const scene::Chart kDots{.pattern = scene::PointGrid{9, 7, 30.0, 8.0}};
const scene::Chart kSquares{.pattern = scene::SlantedEdges{7, 5, 45.0, 27.0, 5.0}};
const scene::Chart kLines{.pattern = scene::StraightLines{9, 7, 30.0, 2.0}};

// The measurement's own target, 0.02 px at 1 % noise, for what a perspective camera sees at a slant. White dots of 8 px
// hold a third of the discs' light against the same noise: 0.03 px.
TEST(CalibrationLattice, PointsOfEveryKindAreWithinTwoHundredthsOfAPixel) {
    for (const scene::Chart& chart : {kDiscs, kDots, kSquares, kLines}) {
        const bool is_dots = std::holds_alternative<scene::PointGrid>(chart.pattern);
        for (const Shot& shot :
             {Shot{.blur_px = 0.7, .noise = 0.01}, Shot{.tilt_deg = 35.0, .blur_px = 0.7, .noise = 0.01, .seed = 5}}) {
            const Errors e = errors(chart, take(chart, perspective_camera(), shot));
            EXPECT_GE(e.count, static_cast<int>(scene::feature_points(chart).size())) << scene::kind_name(chart);
            EXPECT_LT(e.rms_px, is_dots ? 0.03 : 0.02) << scene::kind_name(chart) << ", tilt " << shot.tilt_deg;
            EXPECT_LT(std::hypot(e.bias_px.x, e.bias_px.y), is_dots ? 0.012 : 0.008) << scene::kind_name(chart);
        }
    }
}

TEST(CalibrationLattice, ChartsBentByAFisheye) {
    for (const scene::Chart& chart : {kDiscs, kLines}) {
        const Errors e =
            errors(chart, take(chart, fisheye_camera(), {.tilt_deg = 8.0, .noise = 0.005, .distance_mm = 130.0}));
        EXPECT_GE(e.count, 50) << scene::kind_name(chart);
        EXPECT_LT(e.rms_px, 0.03) << scene::kind_name(chart);
    }
}

// What the frame cuts off is missing; the rest stands in its rows and columns, at a whole number of pitches.
TEST(CalibrationLattice, APartOfADiscGridCounts) {
    Shot shot{.noise = 0.01, .distance_mm = 500.0, .aside_mm = {90.0, 0.0}};
    Taken taken = take(kDiscs, perspective_camera(), shot);
    const Detection detection = detect(taken.image, kDiscs);
    ASSERT_TRUE(detection.found()) << detection.reason;
    const ChartPoints points = refine(taken.image, 0, detection.points, kDiscs);
    ASSERT_GE(count_found(points), 35);
    ASSERT_LT(count_found(points), 63);
    int shift = 100;  // of columns, the same for all
    for (int i = 0; i < 63; ++i) {
        for (int j = 9 * (i / 9); points.found[i] && j < 9 * (i / 9) + 9; ++j) {
            if (std::hypot(points.image_px[i].x - taken.truth_px[j].x, points.image_px[i].y - taken.truth_px[j].y) <
                0.1) {
                shift = shift == 100 ? j - i : shift;
                EXPECT_EQ(j - i, shift);
            }
        }
    }
    EXPECT_LT(std::abs(shift), 9);
}

TEST(CalibrationLattice, AnotherGridHasItsReason) {
    const Taken taken = take(kDiscs, perspective_camera(), {});
    EXPECT_EQ(detect(taken.image, scene::Chart{.pattern = scene::DiscGrid{5, 4, 30.0, 15.0}}).reason,
              "a grid of 9 × 7 discs found, more than the 5 × 4 discs of the chart");
    EXPECT_EQ(detect(taken.image, scene::Chart{.pattern = scene::DiscGrid{30, 20, 30.0, 15.0}}).reason,
              "only 63 of 30 × 20 discs found in rows and columns");
}

}  // namespace lensproof::calibration::lattice_test
