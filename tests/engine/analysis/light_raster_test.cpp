// Light over triangles on pixels, against sums of points and what has to be kept.
#include "engine/analysis/light_raster.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace lensproof::analysis::light_raster_test {

using Triangle = std::array<Vec2d, 3>;

double total(const LightRaster& raster) {
    const std::vector<double> pixels = raster.pixels();
    return std::accumulate(pixels.begin(), pixels.end(), 0.0);
}

Triangle random_triangle(std::mt19937_64& random, double reach) {
    std::uniform_real_distribution<double> at(-reach, reach);
    Triangle triangle;
    for (Vec2d& corner : triangle) {
        corner.x = at(random);
        corner.y = at(random);
    }
    return triangle;
}

// Of a triangle within the sensor nothing is lost, whichever way round it is. The slimmest that is spread by its area
// has 1e-4 of a pixel, of which rounding in sums of numbers up to 20 leaves 1e-10.
TEST(LightRaster, KeepsAllLight) {
    std::mt19937_64 random(1);
    LightRaster raster(20, 20, 0.5);
    for (int i = 0; i < 1000; ++i) {
        raster.clear();
        raster.add(random_triangle(random, 4.99), 3.0);
        ASSERT_NEAR(total(raster), 3.0, 1e-10) << i;
    }
}

// Each pixel against 400 × 400 points, evenly over the triangle of 9 pixels: of a pixel's, no more than its sides' rows
// fall in or out wrongly, which is 4 · 133 points of 160 000 at most.
TEST(LightRaster, SharesAreAreas) {
    const Triangle triangle{{{-2.3, -1.1}, {1.9, -2.2}, {0.4, 2.4}}};
    LightRaster raster(6, 5, 1.0);
    raster.add(triangle, 1.0);
    std::vector<double> counted(30);
    constexpr int kAcross = 400;
    for (int i = 0; i < kAcross; ++i) {
        for (int j = 0; j < kAcross; ++j) {
            double s = (i + 0.5) / kAcross;
            double t = (j + 0.5) / kAcross;
            if (s + t > 1.0) {
                s = 1.0 - s;
                t = 1.0 - t;
            }
            const Vec2d at = triangle[0] + s * (triangle[1] - triangle[0]) + t * (triangle[2] - triangle[0]);
            // Upright: x runs to the left, y down.
            const auto u = static_cast<std::size_t>(3.0 - at.x);
            const auto v = static_cast<std::size_t>(at.y + 2.5);
            counted.at(v * 6 + u) += 1.0 / (kAcross * kAcross);
        }
    }
    const std::vector<double> pixels = raster.pixels();
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        EXPECT_NEAR(pixels[i], counted[i], 4.0 * 133.0 / (kAcross * kAcross)) << i;
    }
}

// What lies beyond the sensor is lost, and nothing else: a larger sensor has the same in its middle.
TEST(LightRaster, ClipsAtTheSensorsEdge) {
    std::mt19937_64 random(2);
    for (int i = 0; i < 200; ++i) {
        const Triangle triangle = random_triangle(random, 12.0);
        LightRaster small(8, 6, 1.0);
        LightRaster large(28, 26, 1.0);
        small.add(triangle, 1.0);
        large.add(triangle, 1.0);
        const std::vector<double> inner = small.pixels();
        const std::vector<double> all = large.pixels();
        for (std::size_t v = 0; v < 6; ++v) {
            for (std::size_t u = 0; u < 8; ++u) {
                ASSERT_NEAR(inner[v * 8 + u], all[(v + 10) * 28 + u + 10], 1e-12) << i << ": " << u << ", " << v;
            }
        }
    }
}

// Where the map folds, a triangle without area is a line of light, and one without any extent a point.
TEST(LightRaster, TrianglesWithoutAreaStayFinite) {
    LightRaster raster(10, 10, 1.0);
    raster.add({{{-4.0, 0.25}, {4.0, 0.25}, {1.0, 0.25}}}, 1.0);
    EXPECT_NEAR(total(raster), 1.0, 1e-12);
    const std::vector<double> pixels = raster.pixels();
    // As dense as its projection: growing from x = −4 to 1, then falling, from 0 to 2 / 8 and back.
    for (std::size_t u = 1; u < 9; ++u) {
        const double x = 4.5 - static_cast<double>(u);
        const double density = x < 1.0 ? 0.25 * (x + 4.0) / 5.0 : 0.25 * (4.0 - x) / 3.0;
        EXPECT_NEAR(pixels[50 + u], density, 0.02) << u;
    }
    raster.clear();
    raster.add({{{1.5, 2.5}, {1.5, 2.5}, {1.5, 2.5}}}, 2.0);
    EXPECT_NEAR(raster.pixels()[7 * 10 + 3], 2.0, 1e-12);
}

}  // namespace lensproof::analysis::light_raster_test
