// The whole chain against the lens's own rays: render a chart, measure it as a photo, compare with traced curves.
// Renders are of the demo's scenes at half their resolution, which keeps them quick; limits in pixels are therefore of
// larger pixels.
#include "experiments/studies/cameras/closed_loop.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "calibration/profile/curve_difference.h"
#include "engine/base/data_root.h"
#include "experiments/studies/cameras/simulations.h"

namespace lensproof::closed_loop_test {

/// One simulation of the demo, at half its resolution.
studies::Simulation half_resolution(const std::string& name) {
    findings::ExperimentFile file{.top = TomlTable::read(data_root() / "experiments" / "first_light.toml")};
    const std::vector<studies::Simulation> simulations = studies::simulations_of(file);
    studies::Simulation half = *std::ranges::find(simulations, name, &studies::Simulation::name);
    render::Sensor& sensor = half.scene.camera.sensor;
    sensor = {sensor.width / 2, sensor.height / 2, 2.0 * sensor.pixel_pitch_mm};
    return half;
}

studies::MeasuredCamera measured(const studies::Simulation& simulation) {
    const render::Camera camera(simulation.scene.camera, simulation.scene.spectral, {}, {});
    return studies::measure_simulation(simulation, camera, {.self_test = false}, [](const std::string&, double) {});
}

/// Of the largest difference from seed to seed: with half as many pixels the fisheye's is 0.18 ± 0.025 px over eight of
/// them, whatever way the pupil is sampled.
constexpr double kScatterPx = 0.025;

class ClosedLoop : public testing::TestWithParam<const char*> {};

TEST_P(ClosedLoop, MeasurementFindsWhatTheRaysSay) {
    studies::Simulation half = half_resolution(GetParam());
    // Squares keep enough pixels for a corner fit.
    auto& board = std::get<scene::Checkerboard>(half.scene.chart->chart.pattern);
    board = {.columns = 11, .rows = 8, .square_mm = board.square_mm * board.columns / 11.0};

    const studies::MeasuredCamera camera = measured(half);
    const studies::ClosedLoopLimits& limits = half.limits;
    for (const calibration::ProfileView& view : camera.profile.views) {
        EXPECT_TRUE(view.found) << view.image;
    }
    ASSERT_TRUE(camera.profile.geometry);
    EXPECT_GT(camera.profile.geometry->covered_image_height, 0.7);

    const auto radial = calibration::radial_difference_px(camera.profile, *camera.traced);
    ASSERT_TRUE(radial);
    EXPECT_LT(radial->rms, limits.distortion_rms_px.value());
    EXPECT_LT(radial->largest, limits.distortion_largest_px.value() + 3.0 * kScatterPx);

    const auto vignetting = calibration::difference(camera.profile, *camera.traced, "vignetting_G");
    ASSERT_TRUE(vignetting);
    EXPECT_GT(vignetting->curve.covered_image_height, 0.9);
    EXPECT_LT(100.0 * vignetting->largest, limits.vignetting_percent.value());

    for (const char* curve : {"chromatic_shift_R_px", "chromatic_shift_B_px"}) {
        const auto shift = calibration::difference(camera.profile, *camera.traced, curve);
        ASSERT_TRUE(shift) << curve;
        EXPECT_LT(shift->largest, limits.chromatic_shift_px.value()) << curve << " at " << shift->largest_at;
    }
}

// Discs instead of corners: their centroids are moved by perspective, which the fit models, so the lens found is the
// same.
TEST(ClosedLoopDiscs, FindTheSameLens) {
    studies::Simulation simulation = half_resolution("tessar");
    simulation.scene.chart->chart.pattern =
        scene::DiscGrid{.columns = 13, .rows = 9, .pitch_mm = 450.0, .diameter_mm = 260.0};
    simulation.views.resize(5);
    simulation.flat_field = false;
    const studies::MeasuredCamera camera = measured(simulation);
    const auto radial = calibration::radial_difference_px(camera.profile, *camera.traced);
    ASSERT_TRUE(radial);
    EXPECT_LT(radial->rms, simulation.limits.distortion_rms_px.value());
    EXPECT_LT(radial->largest, simulation.limits.distortion_largest_px.value());
}

INSTANTIATE_TEST_SUITE_P(Lenses, ClosedLoop, testing::Values("tessar", "petzval", "muller-fisheye"),
                         [](const auto& suite) {
                             std::string name = suite.param;
                             std::erase(name, '-');
                             return name;
                         });

}  // namespace lensproof::closed_loop_test
