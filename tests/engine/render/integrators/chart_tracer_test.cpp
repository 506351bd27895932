#include "engine/render/integrators/chart_tracer.h"

#include <gtest/gtest.h>

#include <random>

namespace lensproof::render::chart_tracer_test {

// From points that are chosen on a turned chart: half of the rays run towards theirs, the others away from it.
TEST(ChartMeetings, AreWhereRaysWereAimed) {
    const EvenChart chart{.chart = {.pattern = scene::Checkerboard{8, 6, 20.0}},
                          .pose = scene::place({.distance_mm = 500.0, .tilt_deg = {-10.0, 25.0, 5.0}}),
                          .white_radiance = {}};
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    CameraPathBuffer paths(1001);
    std::vector<Vec2d> aims;
    for (paths.size = 0; paths.size < paths.capacity; ++paths.size) {
        const auto i = static_cast<std::size_t>(paths.size);
        aims.push_back({100.0 * unit(random), 80.0 * unit(random)});
        const Vec3d aim = scene::camera_to_lens(map_point(chart.pose, {aims.back().x, aims.back().y, 0.0}));
        const Vec3d from{10.0 * unit(random), 10.0 * unit(random), unit(random)};
        const Vec3d direction = (i % 2 == 0 ? 1.0 : -1.0) * normalized(aim - from);
        paths.origin.x[i] = from.x;
        paths.origin.y[i] = from.y;
        paths.origin.z[i] = from.z;
        paths.direction.x[i] = direction.x;
        paths.direction.y[i] = direction.y;
        paths.direction.z[i] = direction.z;
    }
    ChartMeetings found;
    found.meet(chart, paths);
    int black = 0;
    for (std::size_t i = 0; i < aims.size(); ++i) {
        ASSERT_EQ(found.exists(i), i % 2 == 0) << i;
        const Vec2d at = found.point_mm(i);
        if (!found.exists(i)) {
            EXPECT_EQ(at, Vec2d());
            EXPECT_EQ(found.reflectance(i), chart.chart.white_reflectance) << "the world's";
            continue;
        }
        // Coordinates of up to 600 mm through two turns of three products each, a direction's norm and a quotient:
        // sixteen roundings at most.
        EXPECT_NEAR(at.x, aims[i].x, 600.0 * 16.0 * 0x1p-53) << i;
        EXPECT_NEAR(at.y, aims[i].y, 600.0 * 16.0 * 0x1p-53) << i;
        EXPECT_EQ(found.reflectance(i), scene::reflectance(chart.chart, at.x, at.y)) << i;
        EXPECT_EQ(found.is_before(i), point_before(chart.pose, {}).z > 0.0) << "the side that the camera is on";
        black += found.reflectance(i) == chart.chart.black_reflectance ? 1 : 0;
    }
    EXPECT_GT(black, 100);
}

}  // namespace lensproof::render::chart_tracer_test
