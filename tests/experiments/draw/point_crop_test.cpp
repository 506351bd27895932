// A point's neighbourhood as a drawing: the right pixels, and the marks where they belong.
#include "experiments/draw/point_crop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/complaint.h"

namespace lensproof::draw::point_crop_test {

/// Dim, with one bright pixel.
formats::Image picture_with_a_star(int star_x, int star_y) {
    formats::Image picture = formats::make_image(60, 50, {"R", "G"});
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            picture.at(x, y, 1) = 0.2F;
        }
    }
    picture.at(star_x, star_y, 1) = 0.7F;
    return picture;
}

TEST(PointCrop, HoldsThePixelsAboutThePoint) {
    const PointCrop crop("one", picture_with_a_star(30, 25), 1, {30.3, 24.8});
    EXPECT_EQ(crop.corner_px.x, 14.0);
    EXPECT_EQ(crop.corner_px.y, 9.0);
    for (int y = 0; y < kCropSide; ++y) {
        for (int x = 0; x < kCropSide; ++x) {
            EXPECT_EQ(crop.grey.at(x, y, 0), x == 16 && y == 16 ? 1.0F : 0.0F) << x << ", " << y;
        }
    }
}

TEST(PointCrop, IsBlackBeyondThePicture) {
    const PointCrop crop("corner", picture_with_a_star(0, 0), 1, {0.0, 0.0});
    EXPECT_EQ(crop.grey.at(16, 16, 0), 1.0F);
    EXPECT_EQ(crop.grey.at(0, 0, 0), 0.0F);
    EXPECT_EQ(crop.grey.at(16, 15, 0), 0.0F);
}

/// A pixel is 6 px of the drawing; the label above takes 17.
TEST(PointCrop, MarksStandInTheirPixels) {
    const PointCrop crop("one", picture_with_a_star(30, 25), 1, {30.0, 25.0});
    const std::string svg = point_crops_svg(
        {crop, crop},
        {{.at_px = {30.0, 25.0}, .label = "found"}, {.at_px = {31.0, 24.5}, .label = "twin", .is_expected = true}});
    // The middle of pixel 16 of the crop: 99, and 198 + 8 further in the second.
    EXPECT_TRUE(says(svg, "M90 116 108 116"));
    EXPECT_TRUE(says(svg, "M296 116 314 116"));
    EXPECT_TRUE(says(svg, "cx=\"105\" cy=\"113\""));
    EXPECT_TRUE(says(svg, "found"));
}

}  // namespace lensproof::draw::point_crop_test
