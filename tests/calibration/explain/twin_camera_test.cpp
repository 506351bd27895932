#include "calibration/explain/twin_camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/calibration/explain/simulated_profile.h"

namespace lensproof::calibration::twin_camera_test {
namespace {

using explain_test::Faults;
using explain_test::Studio;

/// Where the twin's camera images a point of its chart, px: the mean of green's two wavelengths.
Vec2d imaged_by(const TwinCamera& twin, const ExplainedLens& lens, const SeenCamera& camera, const AffineMap& chart,
                const Vec3d& board) {
    const Vec3d at = map_point(chart, board);
    Vec2d mean;
    for (const double nm : lens.wavelengths_nm[1]) {
        const ChangedLens traced(twin.lens, nm, {}, Eigen::VectorXd(), 0);
        const Vec2d mm = traced.image_of({at.x, -at.y, -at.z}, std::nullopt, false)->image_mm;
        mean = mean + 0.5 * mm;
    }
    // As engine/render/film/sensor.h has it.
    return {0.5 * (camera.width_px - 1) + twin.axis_from_middle_px.x - mean.x / twin.pixel_pitch_mm,
            0.5 * (camera.height_px - 1) + twin.axis_from_middle_px.y + mean.y / twin.pixel_pitch_mm};
}

TEST(TwinCamera, ImagesWhereTheChangedLensDoes) {
    const Studio studio;
    SeenPoints seen = explain_test::studio_points(studio);
    const ExplainedLens lens = explained_lens(formats::load_lens(studio.lens), seen, studio.free, studio.distance_mm);
    LensState state = start_of(lens, seen);
    state.changes = explain_test::values_of(lens.changes, {{"focus_mm", 0.3},
                                                           {"gap_3_mm", 0.1},
                                                           {"gap_6_mm", -0.05},
                                                           {"decentre_x_1_3_mm", 0.2},
                                                           {"decentre_y_7_8_mm", -0.15},
                                                           {"tilt_x_5_6_deg", 0.4},
                                                           {"tilt_y_1_3_deg", -0.3},
                                                           {"sensor_tilt_x_deg", 0.5},
                                                           {"sensor_tilt_y_deg", -0.7},
                                                           {"n_d_1", 0.004},
                                                           {"V_d_1", 1.5},
                                                           {"n_d_7", -0.003},
                                                           {"scale", 2e-3},
                                                           {"sensor_shift_x_mm", 0.31},
                                                           {"sensor_shift_y_mm", -0.22}});
    const auto predicted = predicted_points(lens, seen, state);
    ASSERT_TRUE(predicted);
    const TwinCamera twin = twin_camera(lens, seen, state);
    EXPECT_FALSE(twin.lens.is_rotationally_symmetric);
    for (const std::size_t view : {0, 1, 5}) {
        for (const std::size_t i : {0, 4, 31, 53}) {
            const Vec2d px = imaged_by(twin, lens, seen.camera, twin.charts[view], seen.views[view].points[i].board_mm);
            // The rest is the same trace in other numbers; a table of N-SK16 every 5 nm keeps its formula to 1.4e-9.
            EXPECT_NEAR(px.x, (*predicted)[view][i].x, 5e-3);
            EXPECT_NEAR(px.y, (*predicted)[view][i].y, 5e-3);
        }
    }
}

TEST(TwinCamera, LeavesALensThatIsAsPrescribedAlone) {
    const Studio studio;
    SeenPoints seen = explain_test::studio_points(studio);
    const ExplainedLens lens = explained_lens(formats::load_lens(studio.lens), seen, {}, studio.distance_mm);
    const TwinCamera twin = twin_camera(lens, seen, start_of(lens, seen));
    EXPECT_TRUE(twin.lens.is_rotationally_symmetric);
    EXPECT_EQ(twin.lens.image_z, lens.focused.front().image_z);
    EXPECT_EQ(twin.pixel_pitch_mm, seen.camera.pitch_mm);
}

}  // namespace
}  // namespace lensproof::calibration::twin_camera_test
