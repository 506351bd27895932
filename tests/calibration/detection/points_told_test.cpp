// What is said of the points found: their errors, which is which, and whether lines are straight.
#include <gtest/gtest.h>

#include "calibration/detection/line_points.h"
#include "calibration/profile/profile_line.h"
#include "calibration/self_test/simulated_chart.h"
#include "engine/scene/chart/aruco.h"
#include "tests/calibration/shot.h"

namespace lensproof::calibration::points_told_test {

using namespace synthetic;

const scene::Chart kBoard{.pattern = scene::Checkerboard{10, 7, 30.0}};
const scene::Chart kDiscs{.pattern = scene::DiscGrid{9, 6, 33.0, 18.0}};
const scene::Chart kDots{.pattern = scene::PointGrid{9, 6, 33.0, 10.0}};
const scene::Chart kLines{.pattern = scene::StraightLines{9, 7, 30.0, 2.0}};

ChartPoints exact(const Taken& taken) {
    return {.image_px = taken.truth_px, .found = std::vector<bool>(taken.truth_px.size(), true)};
}

/// Scatter of the points over noises, over what was stated: 1.
double chi_squared(const scene::Chart& chart, const Taken& clean, int trials) {
    const std::size_t count = clean.truth_px.size();
    std::vector<double> sum(2 * count);
    std::vector<double> squares(2 * count);
    std::vector<double> stated(2 * count);
    for (int trial = 0; trial < trials; ++trial) {
        formats::Image image = clean.image;
        add_noise(image, 0.01, static_cast<unsigned>(trial));
        const ChartPoints points = refine(image, 0, exact(clean), chart);
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_TRUE(points.found[i] && points.standard_error_px[i]) << scene::kind_name(chart) << i;
            const Vec2d error = points.standard_error_px[i].value_or(Vec2d{});
            for (const std::size_t axis : {0U, 1U}) {
                const double off =
                    axis == 0 ? points.image_px[i].x - clean.truth_px[i].x : points.image_px[i].y - clean.truth_px[i].y;
                sum[2 * i + axis] += off;
                squares[2 * i + axis] += off * off;
                stated[2 * i + axis] += axis == 0 ? error.x * error.x : error.y * error.y;
            }
        }
    }
    double chi = 0.0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
        const double scatter = (squares[i] - sum[i] * sum[i] / trials) / (trials - 1);
        chi += scatter / (stated[i] / trials) / static_cast<double>(sum.size());
    }
    return chi;
}

// 54 points, two coordinates, ten noises: chi² has a standard deviation of √(2 / 972) = 0.045. The noise is found to
// 3 %, 6 % of chi², edges making it rather too large.
TEST(CalibrationPointsTold, StandardErrorsAreTheScatterOverNoises) {
    for (const scene::Chart& chart : {kBoard, kDiscs, kDots}) {
        const Taken clean = take(chart, perspective_camera(), {.tilt_deg = 25.0, .blur_px = 0.7});
        const double chi = chi_squared(chart, clean, 10);
        EXPECT_GT(chi, 0.80) << scene::kind_name(chart);
        EXPECT_LT(chi, 1.15) << scene::kind_name(chart);
    }
}

// The white paper around black cells stood in the window of the outermost dots: without noise, they were 0.02 px off
// and more with tilt and blur.
TEST(CalibrationPointsTold, DotsBesideWhitePaperAreWhereTheyAre) {
    const Taken taken = take(kDots, perspective_camera(), {.tilt_deg = 35.0, .blur_px = 0.7});
    const ChartPoints points = refine(taken.image, 0, exact(taken), kDots);
    double squares = 0.0;
    for (std::size_t i = 0; i < points.found.size(); ++i) {
        ASSERT_TRUE(points.found[i]);
        squares += std::pow(points.image_px[i].x - taken.truth_px[i].x, 2) +
                   std::pow(points.image_px[i].y - taken.truth_px[i].y, 2);
    }
    EXPECT_LT(std::sqrt(0.5 * squares / static_cast<double>(points.found.size())), 0.008);
}

Numbering numbering(const scene::Chart& chart, const Shot& shot) {
    const Detection detection = detect(take(chart, perspective_camera(), shot).image, chart);
    EXPECT_TRUE(detection.found()) << detection.reason;
    return detection.numbering;
}

TEST(CalibrationPointsTold, WhichPointIsWhichIsSaid) {
    EXPECT_EQ(numbering(kBoard, {}), Numbering::certain);  // 10 + 7 squares: odd
    EXPECT_EQ(numbering({.pattern = scene::Checkerboard{9, 7, 30.0}}, {}), Numbering::half_turn);
    EXPECT_EQ(numbering({.pattern = scene::Checkerboard{7, 7, 30.0}}, {}), Numbering::quarter_turn);
    EXPECT_EQ(numbering(kDiscs, {}), Numbering::half_turn);
    EXPECT_EQ(numbering(kDiscs, {.distance_mm = 500.0, .aside_mm = {90.0, 0.0}}), Numbering::whole_pitches);
    EXPECT_EQ(numbering_in_words(Numbering::certain), "");
    EXPECT_NE(numbering_in_words(Numbering::whole_pitches).find("whole pitches"), std::string::npos);
}

// Every crossing, upright, turned and tilted; half cells beyond the outermost lines were taken for cells.
TEST(CalibrationPointsTold, AllCrossingsOfLinesAreFound) {
    for (const Shot& shot :
         {Shot{.roll_deg = 0.0, .blur_px = 0.7, .noise = 0.01}, Shot{.roll_deg = 30.0, .blur_px = 0.7, .noise = 0.01},
          Shot{.tilt_deg = 35.0, .blur_px = 0.7, .noise = 0.01}}) {
        const Errors e = errors(kLines, take(kLines, perspective_camera(), shot));
        EXPECT_EQ(e.count, 63) << "roll " << shot.roll_deg << ", tilt " << shot.tilt_deg;
        EXPECT_LT(e.rms_px, 0.02);
    }
}

// Barrel distortion of a few per cent: under the lens's own model lines are straight to the noise of their points;
// without its distortion they bend by far more; and with k1 a tenth off still by clearly more than noise.
TEST(CalibrationPointsTold, LinesAreStraightUnderTheTrueModelAlone) {
    SimulatedCamera camera{.model = perspective_camera(), .width_px = 640, .height_px = 480, .channels = {{"Y"}}};
    camera.white = 0.9;
    camera.read_noise = 0.005;
    const Pose pose{{0.18, -0.16, 0.07}, {0.0, 0.0, 640.0}};
    const formats::Image image = simulate_chart(camera, pose, kLines, 3);
    const ChartPoints crossings{.image_px = view_of(camera.model, pose, kLines).image_px,
                                .found = std::vector<bool>(63, true)};
    const std::vector<LinePoints> lines = line_points(image, 0, crossings, kLines);
    ASSERT_EQ(lines.size(), 16U);
    const auto chi = [&](double k1_factor) {
        BrownConrady model = perspective_camera();
        model.parameters[3] *= k1_factor;
        const std::vector<ProfileLine> straight = straightness(lines, model);
        EXPECT_EQ(straight.size(), 16U);
        double sum = 0.0;
        for (const ProfileLine& line : straight) {
            EXPECT_GE(line.points, 18);  // 3 between each two of at least 7 crossings
            sum += std::pow(line.rms_px / line.noise_px, 2) / static_cast<double>(straight.size());
        }
        return sum;
    };
    // 16 lines of 18 to 24 points: chi² of 1 ± 0.07, and the noise's own error. What a model leaves out adds its
    // square: a tenth of k1 a hundredth of all of it, so that 4.2 and 332 were found; chance reaches 1.3.
    EXPECT_NEAR(chi(1.0), 1.0, 0.3);
    EXPECT_GT(chi(0.9), 3.0);
    EXPECT_GT(chi(0.0), 200.0);
}

}  // namespace lensproof::calibration::points_told_test
