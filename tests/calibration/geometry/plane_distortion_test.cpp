#include "calibration/geometry/plane_distortion.h"

#include <gtest/gtest.h>

#include "engine/base/input_error.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::plane_distortion_test {

using namespace synthetic;

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr double kHalfDiagonal = 400.0;
const scene::Chart kBoard{.pattern = scene::Checkerboard{14, 11, 30.0}};

// Brown's radial terms about the picture's middle, of which the second of three is not there: the formula of the plane
// with k_i h^2i / f^2i.
BrownConrady centred_camera() {
    return {{820.0, 319.5, 239.5, -0.24, 0.0, 0.5, 0.0, 0.0}};
}

double exact_percent(double height) {
    const double radius = height * kHalfDiagonal;
    const double angle = *field_angle_rad(centred_camera(), radius);
    return 100.0 * (radius / (820.0 * std::tan(angle)) - 1.0);
}

const Pose kFacing{{0.0, 0.0, 0.0}, {3.0, -2.0, 560.0}};
const Pose kTilted{{0.5, -0.3, 0.1}, {-10.0, 5.0, 700.0}};

// However the chart stands, its homography takes the pose up and leaves the distortion: without noise, to the steps'
// own end (1e-10 of parameters of the order of 1, amplified by their correlation; percent).
TEST(PlaneDistortion, IsTheLensesWhateverThePose) {
    for (const std::vector<Pose>& poses : {std::vector{kFacing}, {kTilted}, {kFacing, kTilted}}) {
        std::vector<ChartView> views;
        views.reserve(poses.size());
        for (const Pose& pose : poses) {
            views.push_back(view_of(centred_camera(), pose, kBoard));
        }
        const PlaneDistortion found = fit_plane_distortion(views, kWidth, kHeight);
        EXPECT_LT(found.rms_px, 1e-7);
        ASSERT_EQ(found.coefficients.size(), 3u);
        EXPECT_NEAR(found.coefficients[0], -0.24 * std::pow(kHalfDiagonal / 820.0, 2), 1e-6);
        const Curve curve = distortion_curve(found, kHalfDiagonal);
        for (const double height : {0.25, 0.5, 0.75}) {
            EXPECT_NEAR(sample(curve, height)->value, exact_percent(height), 1e-5) << height;
        }
    }
}

// Of 200 noisy views the 95 % bands hold the truth in 90 to 99 %: of 200 that are right, 88.5 % to 99 % lie within four
// standard deviations (1.54 %).
TEST(PlaneDistortion, ItsBandsHoldTheTruth) {
    const ChartView exact = view_of(centred_camera(), kTilted, kBoard);
    int held = 0;
    for (unsigned seed = 0; seed < 200; ++seed) {
        ChartView noisy = exact;
        Noise noise(seed);
        for (Vec2d& pixel : noisy.image_px) {
            pixel = {pixel.x + 0.05 * noise(), pixel.y + 0.05 * noise()};
        }
        const Curve curve = distortion_curve(fit_plane_distortion({noisy}, kWidth, kHeight), kHalfDiagonal);
        const Banded at = *sample(curve, 0.6);
        held += at.lower_95 <= exact_percent(0.6) && exact_percent(0.6) <= at.upper_95 ? 1 : 0;
    }
    EXPECT_GE(held, 177);
    EXPECT_LE(held, 199);
}

// A corner that was found 5 px away is left out, and moves nothing.
TEST(PlaneDistortion, LeavesOutliersOut) {
    ChartView view = view_of(centred_camera(), kFacing, kBoard);
    view.image_px[17].x += 5.0;
    const PlaneDistortion found = fit_plane_distortion({view}, kWidth, kHeight);
    EXPECT_EQ(found.points_used, static_cast<int>(view.image_px.size()) - 1);
    EXPECT_FALSE(found.residuals[0][17].used);
    EXPECT_NEAR(found.residuals[0][17].measured_minus_model_px.x, 5.0, 1e-4);
    EXPECT_NEAR(sample(distortion_curve(found, kHalfDiagonal), 0.6)->value, exact_percent(0.6), 1e-4);
}

TEST(PlaneDistortion, RefusesWhatDetermineNone) {
    ChartView line = view_of(centred_camera(), kFacing, kBoard);
    line.chart_mm.resize(10);  // the first row
    line.image_px.resize(10);
    EXPECT_THROW(fit_plane_distortion({line}, kWidth, kHeight), InputError);
    ChartView four = view_of(centred_camera(), kFacing, {.pattern = scene::Checkerboard{3, 3, 30.0}});
    EXPECT_THROW(fit_plane_distortion({four}, kWidth, kHeight), InputError);
}

}  // namespace lensproof::calibration::plane_distortion_test
