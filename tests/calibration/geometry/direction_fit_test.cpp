// Cameras from directions that are known: stars.
#include <gtest/gtest.h>

#include <numbers>

#include "calibration/geometry/handedness.h"
#include "calibration/geometry/model_choice.h"
#include "calibration/geometry/projection_uncertainty.h"
#include "engine/base/angle.h"
#include "tests/calibration/geometry/starry_view.h"
#include "tests/complaint.h"

namespace lensproof::calibration::direction_fit_test {

using namespace synthetic;

constexpr int kWidth = 640;
constexpr int kHeight = 480;
const Pose kAnyhow{.rotation_rad = {0.7, -1.9, 1.1}, .translation_mm = {}};

GeometryOptions of(ModelKind model) {
    return {.model = model};
}

void blur(ChartView& view, double sigma_px, unsigned seed) {
    Noise noise(seed);
    for (Vec2d& p : view.image_px) {
        p = p + sigma_px * Vec2d{noise(), noise()};
    }
}

// As with charts, exact projections leave rounding alone: 1e-13 px, times the conditioning of the worst parameter.
TEST(DirectionFit, ExactDirectionsGiveBackTheCamera) {
    const BrownConrady truth = perspective_camera();
    const ChartView view = starry_view(truth, kAnyhow, kWidth, kHeight, 60, 1);
    const GeometryFit fit = fit_geometry({view}, kWidth, kHeight, of(ModelKind::brown_conrady));
    for (std::size_t i = 0; i < truth.parameters.size(); ++i) {
        EXPECT_NEAR(parameters(fit.model)[i], truth.parameters[i], 1e-6) << BrownConrady::names[i];
    }
    EXPECT_LT(fit.rms_px, 1e-8);
    EXPECT_LT(length(fit.views[0].pose.rotation_rad - kAnyhow.rotation_rad), 1e-8);
    EXPECT_EQ(length(fit.views[0].pose.translation_mm), 0.0);
}

TEST(DirectionFit, ExactDirectionsGiveBackTheFisheyeBeyond90Degrees) {
    const KannalaBrandt truth = fisheye_camera();
    const ChartView view = starry_view(truth, kAnyhow, kWidth, kHeight, 80, 2);
    double widest = 0.0;
    for (const Vec3d& direction : view.directions) {
        widest = std::max(widest, std::acos(turned(kAnyhow, direction).z));
    }
    ASSERT_GT(widest, radians(95.0));
    const GeometryFit fit = fit_geometry({view}, kWidth, kHeight, of(ModelKind::kannala_brandt));
    for (std::size_t i = 0; i < truth.parameters.size(); ++i) {
        EXPECT_NEAR(parameters(fit.model)[i], truth.parameters[i], 1e-6) << KannalaBrandt::names[i];
    }
}

// Stars tell the far camera, charts the near one; one model serves both.
TEST(DirectionFit, StarsAndChartsTogether) {
    const BrownConrady truth = perspective_camera();
    const scene::Chart board{.pattern = scene::Checkerboard{10, 7, 30.0}};
    std::vector<ChartView> views = {starry_view(truth, kAnyhow, kWidth, kHeight, 30, 3)};
    for (const Pose& pose : tilted_poses(600.0, 0.4, 60.0)) {
        views.push_back(view_of(truth, pose, board));
    }
    const GeometryFit fit = fit_geometry(views, kWidth, kHeight, of(ModelKind::brown_conrady));
    for (std::size_t i = 0; i < truth.parameters.size(); ++i) {
        EXPECT_NEAR(parameters(fit.model)[i], truth.parameters[i], 1e-6) << BrownConrady::names[i];
    }
}

TEST(DirectionFit, AWrongStarIsLeftOut) {
    const BrownConrady truth = perspective_camera();
    ChartView view = starry_view(truth, kAnyhow, kWidth, kHeight, 60, 4);
    blur(view, 0.1, 5);
    view.image_px[17].y += 7.0;  // its neighbour
    const GeometryFit fit = fit_geometry({view}, kWidth, kHeight, of(ModelKind::brown_conrady));
    EXPECT_FALSE(fit.views[0].residuals[17].used);
    EXPECT_EQ(fit.points_used, 59);
    EXPECT_NEAR(focal_length_px(fit.model), truth.parameters[0], 5.0 * fit.standard_error(0));
}

// Of 200 intervals 190 hold the truth, give or take 3.1: from 177, four times that, all is as stated. The noise is
// estimated from 109 degrees of freedom, for which Student's t is 1.98.
TEST(DirectionFit, StatedIntervalsHoldTheTruth) {
    constexpr int kTrials = 200;
    const BrownConrady truth = perspective_camera();
    std::array<int, BrownConrady::count> held{};
    for (unsigned trial = 0; trial < kTrials; ++trial) {
        ChartView view = starry_view(truth, kAnyhow, kWidth, kHeight, 60, 100 + trial);
        blur(view, 0.2, 7000 + trial);
        const GeometryFit fit = fit_geometry({view}, kWidth, kHeight, of(ModelKind::brown_conrady));
        for (std::size_t i = 0; i < held.size(); ++i) {
            const double off = std::abs(parameters(fit.model)[i] - truth.parameters[i]);
            held[i] += off <= 1.98 * fit.standard_error(static_cast<int>(i)) ? 1 : 0;
        }
    }
    for (std::size_t i = 0; i + 1 < held.size(); ++i) {  // the last, the stretch, is held at the truth
        EXPECT_GE(held[i], 177) << BrownConrady::names[i];
        EXPECT_LT(held[i], 200) << BrownConrady::names[i];
    }
}

// What the map of the uncertainty says of a place is the scatter of fits to other noise there: 150 of them tell that to
// 6 %, of which 20 % are three and more.
TEST(DirectionFit, TheUncertaintyIsTheScatterOfRefits) {
    constexpr int kTrials = 150;
    const BrownConrady truth = perspective_camera();
    const ChartView exact = starry_view(truth, kAnyhow, kWidth, kHeight, 60, 6);
    const std::vector<Vec2d> places = {{319.5, 239.5}, {80.0, 60.0}, {600.0, 240.0}};
    std::vector<double> squares(places.size(), 0.0);
    std::vector<double> stated(places.size(), 0.0);
    for (unsigned trial = 0; trial < kTrials; ++trial) {
        ChartView view = exact;
        blur(view, 0.2, 300 + trial);
        const GeometryFit fit = fit_geometry({view}, kWidth, kHeight, of(ModelKind::brown_conrady));
        for (std::size_t i = 0; i < places.size(); ++i) {
            const Vec2d off = imaged_again({kAnyhow}, fit, unproject(truth, places[i]).value(), true) - places[i];
            squares[i] += dot(off, off) / kTrials;
            stated[i] += std::pow(projection_uncertainty_px(fit, places[i]).value(), 2) / kTrials;
        }
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
        // The map has the worst direction's, of two: between half and all of the mean square distance.
        EXPECT_GT(stated[i], 0.5 * squares[i] / 1.44) << i;
        EXPECT_LT(stated[i], squares[i] * 1.44) << i;
    }
}

TEST(DirectionFit, TheMapKnowsNothingNear) {
    ChartView view = starry_view(perspective_camera(), kAnyhow, kWidth, kHeight, 60, 7);
    blur(view, 0.1, 8);
    const GeometryFit fit = fit_geometry({view}, kWidth, kHeight, of(ModelKind::brown_conrady));
    const UncertaintyMap map = uncertainty_map(fit, {view}, kWidth, kHeight, {}, 5);
    EXPECT_TRUE(map.far_px.at(12));
    EXPECT_FALSE(map.near_px.at(12));
    EXPECT_EQ(map.near_mm, 0.0);
}

// One picture is cross-validated by its points, and the model is chosen as with charts. The rms of 300 coordinates is
// known to 4 %; where directions are imaged is off by four errors at most, and by a twentieth of a pixel that a model
// with fewer terms than the truth may not express.
TEST(DirectionFit, AModelIsChosen) {
    ChartView view = starry_view(fisheye_camera(), kAnyhow, kWidth, kHeight, 150, 9);
    blur(view, 0.2, 10);
    const ChosenGeometry chosen = choose_model({view}, kWidth, kHeight, {});
    EXPECT_EQ(chosen.choice.candidates.at(static_cast<std::size_t>(chosen.choice.chosen)).refused, "");
    EXPECT_LT(chosen.fit.rms_px, 1.15 * 0.2 * std::numbers::sqrt2);
    for (const Vec2d& place : {Vec2d{60.0, 60.0}, Vec2d{319.5, 239.5}, Vec2d{560.0, 400.0}}) {
        const double uncertainty = projection_uncertainty_px(chosen.fit, place).value();
        EXPECT_LT(length(imaged_again({kAnyhow}, chosen.fit, unproject(fisheye_camera(), place).value(), true) - place),
                  4.0 * uncertainty + 0.05);
    }
}

TEST(DirectionFit, TooFewAreRefused) {
    const auto complaint = [](int count) {
        const ChartView view = starry_view(perspective_camera(), kAnyhow, kWidth, kHeight, count, 11);
        return complaint_about([&] { fit_geometry({view}, kWidth, kHeight, of(ModelKind::brown_conrady)); });
    };
    EXPECT_TRUE(says(complaint(3), "3 directions and 3 image points"));
    EXPECT_TRUE(says(complaint(5), "5 points in 1 views cannot determine 11 unknowns"));
}

TEST(DirectionFit, MirroredOnesAreNamed) {
    for (const CameraModel& camera : {CameraModel(perspective_camera()), CameraModel(fisheye_camera())}) {
        ChartView view = starry_view(camera, kAnyhow, kWidth, kHeight, 20, 1);
        EXPECT_EQ(complaint_about([&] { check_handedness({view}, kWidth, kHeight); }), "");
        for (Vec3d& direction : view.directions) {
            direction.x = -direction.x;
        }
        EXPECT_TRUE(
            says(complaint_about([&] { check_handedness({view}, kWidth, kHeight); }), "the directions are mirrored"));
    }
}

}  // namespace lensproof::calibration::direction_fit_test
