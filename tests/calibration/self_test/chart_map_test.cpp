#include "calibration/self_test/chart_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/self_test/chart_point.h"

namespace lensproof::calibration::chart_map_test {

const scene::Chart kBoard{.pattern = scene::Checkerboard{10, 7, 30.0}};

struct Case {
    std::string name;
    CameraModel camera;
    Pose pose;
    std::optional<BoardShape> board = std::nullopt;
};

// From a long lens, whose map is cubic over all blocks, to a fisheye that sees the plane's horizon, whose map is exact
// in many.
std::vector<Case> cases() {
    const Pose tilted{{0.35, -0.3, 0.2}, {5.0, -3.0, 420.0}};
    BoardShape bent;
    bent.frame.half_size_mm = {120.0, 90.0};
    bent.height_mm = {1.0, 0.5, -0.7, 0.1, 0.2};
    return {{"long", BrownConrady{{2000.0, 310.0, 245.0, -0.2, 0.05, 0.0, 3e-4, -2e-4}}, tilted},
            {"usual", BrownConrady{{500.0, 310.0, 245.0, -0.2, 0.05, 0.0, 3e-4, -2e-4}}, tilted},
            {"fisheye", KannalaBrandt{{220.0, 319.5, 239.5, 0.02, -0.003}}, {{0.3, 0.2, 0.0}, {0.0, 0.0, 150.0}}},
            {"bent", BrownConrady{{500.0, 310.0, 245.0}}, tilted, bent}};
}

// On the board and a square around, at places of pixels that are no knots, the map is the exact one within 1e-3 px,
// which is what it says; the sides of a pixel are those that the map itself has.
TEST(ChartMap, IsTheExactMapBetweenItsKnots) {
    const cv::Rect frame(-6, -6, 652, 492);
    for (const Case& each : cases()) {
        const auto exact = [&](const Vec2d& pixel) { return chart_point(each.camera, each.pose, pixel, each.board); };
        const ChartMap map(exact, kBoard, frame);
        double worst = 0.0;
        int compared = 0;
        for (int i = 0; i < 20'000; ++i) {
            const int x = (i * 7919) % 640;
            const int y = (i * 104'729) % 480;
            const double u = std::fmod(i * 0.6180339887, 1.0);
            const double v = std::fmod(i * 0.7548776662, 1.0);
            const ChartMap::Pixel pixel = map.pixel(x, y);
            const auto there = exact({x - 0.5 + u, y - 0.5 + v});
            if (!there || std::abs(there->x) > 180.0 || std::abs(there->y) > 135.0) {
                continue;
            }
            // Off by (a, b) pixels: solved for with the pixel's own sides.
            const Vec2d off = pixel.at(u, v) - *there;
            const double area = cross(pixel.along_x, pixel.along_y);
            const double a = cross(off, pixel.along_y) / area;
            const double b = cross(pixel.along_x, off) / area;
            worst = std::max(worst, std::hypot(a, b));
            ++compared;
        }
        EXPECT_LT(worst, 1e-3) << each.name;
        EXPECT_GT(compared, 2'000) << each.name;
    }
}

// Where a cell is said to be even, all of it and two pixels around are of that tone; and most of a picture is.
TEST(ChartMap, EvenCellsHaveNoEdgeNear) {
    for (const Case& each : cases()) {
        const auto exact = [&](const Vec2d& pixel) { return chart_point(each.camera, each.pose, pixel, each.board); };
        const ChartMap map(exact, kBoard, {-6, -6, 652, 492});
        int even = 0;
        for (int y = 0; y < 480; y += 6) {
            for (int x = 0; x < 640; x += 7) {
                const float tone = map.even_tone(x, y);
                if (std::isnan(tone)) {
                    continue;
                }
                ++even;
                for (int k = 0; k < 25; ++k) {
                    const int row = k / 5;
                    const auto place = exact({x + k % 5 - 2.0, y + row - 2.0});
                    ASSERT_TRUE(place) << each.name << " " << x << ", " << y;
                    ASSERT_EQ(static_cast<float>(scene::reflectance(kBoard, place->x, place->y)), tone)
                        << each.name << " " << x << ", " << y;
                }
            }
        }
        EXPECT_GT(even, 0.5 * 80 * 91) << each.name;
    }
}

}  // namespace lensproof::calibration::chart_map_test
