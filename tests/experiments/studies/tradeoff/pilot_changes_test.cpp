// tests/experiments/studies/tradeoff/pilot_changes_test.cpp — effects of a lens done to a picture.
#include "experiments/studies/tradeoff/pilot_changes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lensproof::studies::pilot_changes_test {

using formats::Image;

Image point_at(int x, int y) {
    Image image = formats::make_image(41, 31, {"R", "G", "B"});
    for (int c = 0; c < 3; ++c) {
        image.at(x, y, c) = 1.0F;
    }
    return image;
}

// A lattice's Gaussian has the variance σ² along each axis; cut beyond 3 σ it keeps 0.973 of it and more.
TEST(PilotChanges, ASpreadKeepsLightAndHasItsRadius) {
    for (const double radius : {0.01, 0.1, 0.5, 1.5, 3.0}) {
        const Image spread = with_spread(point_at(20, 15), [&](int, int) { return radius; });
        double light = 0.0;
        double square = 0.0;
        for (int y = 0; y < spread.height; ++y) {
            for (int x = 0; x < spread.width; ++x) {
                light += static_cast<double>(spread.at(x, y, 1));
                square += static_cast<double>(spread.at(x, y, 1)) * ((x - 20) * (x - 20) + (y - 15) * (y - 15));
            }
        }
        EXPECT_NEAR(light, 1.0, 1e-5);
        EXPECT_NEAR(square, radius * radius, 0.04 * radius * radius);  // beyond three sigma lie 3 % of the square
    }
}

TEST(PilotChanges, NoSpreadIsNoChange) {
    const Image point = point_at(3, 4);
    EXPECT_EQ(with_spread(point, [](int, int) { return 0.0; }).pixels, point.pixels);
}

TEST(PilotChanges, AShiftTakesEachColourFromItsPlace) {
    const Image shifted = with_shift(point_at(20, 15), [](int, int, int c) {
        return Vec2d{static_cast<double>(c), -0.5};
    });
    for (int c = 0; c < 3; ++c) {
        EXPECT_FLOAT_EQ(shifted.at(20 - c, 15, c), 0.5F);
        EXPECT_FLOAT_EQ(shifted.at(20 - c, 16, c), 0.5F);
    }
}

TEST(PilotChanges, RingsAreMeansAndLinearBetween) {
    const RadialMean mean({{0.0, 1.0}, {0.2, 3.0}, {0.8, 5.0}, {1.0, 7.0}}, 2);
    EXPECT_DOUBLE_EQ(mean.at(0.0), 2.0);
    EXPECT_DOUBLE_EQ(mean.at(0.1), 2.0);
    EXPECT_DOUBLE_EQ(mean.at(0.5), 4.0);
    EXPECT_DOUBLE_EQ(mean.at(2.0), 6.0);
    EXPECT_DOUBLE_EQ(RadialMean({}, 8).at(0.5), 0.0);
}

}  // namespace lensproof::studies::pilot_changes_test
