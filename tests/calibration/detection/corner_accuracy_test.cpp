#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "calibration/detection/detect.h"
#include "calibration/detection/refine.h"
#include "engine/scene/chart/aruco.h"
#include "tests/calibration/shot.h"

namespace lensproof::calibration::corner_accuracy_test {

using namespace synthetic;

const scene::Chart kBoard{.pattern = scene::Checkerboard{10, 7, 30.0}};

scene::Chart charuco_board() {
    const scene::ArucoDictionary aruco = scene::aruco_dictionary("DICT_4X4_50");
    return {.pattern = scene::CharucoBoard{10, 7, 30.0, 22.0, aruco.cells, aruco.markers}};
}

// 36 samples a pixel place an edge's every pixel to 1/36 of the step: 0.005 px in a corner, about what is left here.
TEST(CalibrationCornerAccuracy, WithoutNoiseCornersAreWithinAHundredthOfAPixel) {
    for (const Shot& shot : {Shot{.tilt_deg = 0.0, .blur_px = 0.5}, Shot{.tilt_deg = 30.0, .blur_px = 1.0},
                             Shot{.tilt_deg = 50.0, .blur_px = 0.0}}) {
        const Errors e = errors(kBoard, take(kBoard, perspective_camera(), shot));
        EXPECT_EQ(e.count, 54);
        EXPECT_LT(e.rms_px, 0.012) << "tilt " << shot.tilt_deg;
        EXPECT_LT(std::hypot(e.bias_px.x, e.bias_px.y), 0.005);
    }
}

// The measurement's own target: 0.02 px at 1 % noise, from sharp to rather blurred.
TEST(CalibrationCornerAccuracy, OnePercentOfNoiseLeavesTwoHundredthsOfAPixel) {
    for (const Shot& shot : {Shot{.blur_px = 0.5, .noise = 0.01, .seed = 1},
                             Shot{.tilt_deg = 30.0, .blur_px = 2.0, .noise = 0.01, .seed = 2},
                             Shot{.tilt_deg = 50.0, .blur_px = 1.0, .noise = 0.01, .seed = 3}}) {
        const Errors e = errors(kBoard, take(kBoard, perspective_camera(), shot));
        EXPECT_GE(e.count, 53);
        EXPECT_LT(e.rms_px, 0.02) << "tilt " << shot.tilt_deg;
    }
}

// OpenCV 4.6 puts ChArUco corners 0.53 px off in x and y. The bar: bias below 0.02 px.
TEST(CalibrationCornerAccuracy, CharucoCornersHaveNoBias) {
    const scene::Chart board = charuco_board();
    for (const Shot& shot :
         {Shot{}, Shot{.blur_px = 1.0, .noise = 0.01}, Shot{.tilt_deg = 40.0, .blur_px = 0.7, .noise = 0.01}}) {
        const Errors e = errors(board, take(board, perspective_camera(), shot));
        EXPECT_GE(e.count, 46);
        EXPECT_LT(std::abs(e.bias_px.x), 0.01);
        EXPECT_LT(std::abs(e.bias_px.y), 0.01);
        EXPECT_LT(e.rms_px, 0.02) << "tilt " << shot.tilt_deg;
    }
}

// At a blur of 1.75 px a marker's cells of 5 px run into one another, and guards of two blurs' widths would leave
// nothing of the white between edges and markers: a sharpened copy shows the markers, and half the white is enough.
TEST(CalibrationCornerAccuracy, ABlurredCharucoBoardIsFoundAndHasNoBias) {
    const scene::Chart board = charuco_board();
    const Errors e = errors(board, take(board, perspective_camera(),
                                        {.tilt_deg = 20.0, .blur_px = 1.75, .noise = 0.01, .distance_mm = 560.0}));
    EXPECT_GE(e.count, 44);
    EXPECT_LT(std::hypot(e.bias_px.x, e.bias_px.y), 0.01);
    EXPECT_LT(e.rms_px, 0.02);
}

// A board that half leaves the frame: the corners in view are found, under their own numbers.
TEST(CalibrationCornerAccuracy, APartOfACharucoBoardCounts) {
    const scene::Chart board = charuco_board();
    const Errors e =
        errors(board, take(board, perspective_camera(),
                           {.tilt_deg = 20.0, .noise = 0.01, .distance_mm = 400.0, .aside_mm = {90.0, -70.0}}));
    EXPECT_GE(e.count, 20);
    EXPECT_LT(e.seen, 50);
    EXPECT_LT(e.rms_px, 0.02);
}

// The markers number the corners whichever way the camera is turned.
TEST(CalibrationCornerAccuracy, ATurnedCharucoBoardKeepsItsNumbers) {
    const scene::Chart board = charuco_board();
    for (const double roll_deg : {90.0, 180.0, -135.0}) {
        const Errors e = errors(board, take(board, perspective_camera(), {.roll_deg = roll_deg, .distance_mm = 800.0}));
        EXPECT_GE(e.count, 45);
        EXPECT_LT(e.worst_px, 0.1) << "roll " << roll_deg;
    }
}

TEST(CalibrationCornerAccuracy, ACharucoBoardBentByAFisheye) {
    const scene::Chart board = charuco_board();
    const Errors e =
        errors(board, take(board, fisheye_camera(), {.tilt_deg = 8.0, .noise = 0.005, .distance_mm = 120.0}));
    EXPECT_GE(e.count, 40);
    EXPECT_LT(e.rms_px, 0.02);
}

TEST(CalibrationCornerAccuracy, AMirroredCharucoBoardIsSaidToBeOne) {
    const scene::Chart board = charuco_board();
    Taken taken = take(board, perspective_camera(), {});
    for (int y = 0; y < taken.image.height; ++y) {
        for (int x = 0; x < taken.image.width / 2; ++x) {
            std::swap(taken.image.at(x, y, 0), taken.image.at(taken.image.width - 1 - x, y, 0));
        }
    }
    EXPECT_EQ(detect(taken.image, board).reason, "the board is seen mirrored");
}

// Markers are numbered row by row, so where they lie tells how many there are in a row.
TEST(CalibrationCornerAccuracy, ACharucoBoardOfAnotherCountIsOffered) {
    scene::Chart board = charuco_board();
    const Taken taken = take(board, perspective_camera(), {.tilt_deg = 10.0});
    auto& stated = std::get<scene::CharucoBoard>(board.pattern);
    const std::string seen = "squares = [" + std::to_string(stated.columns) + ", " + std::to_string(stated.rows) + "]";
    std::swap(stated.columns, stated.rows);
    const std::string reason = detect(taken.image, board).reason;
    EXPECT_NE(reason.find(seen + "), not of"), std::string::npos) << reason;
}

// With one column too many, markers of one row still agree with each other: corners would be found, in wrong places.
TEST(CalibrationCornerAccuracy, ACharucoBoardWithAColumnTooManyIsNotTaken) {
    scene::Chart board = charuco_board();
    const Taken taken = take(board, perspective_camera(), {.tilt_deg = 10.0});
    auto& stated = std::get<scene::CharucoBoard>(board.pattern);
    const std::string seen = "squares = [" + std::to_string(stated.columns) + ", ";
    ++stated.columns;
    ++stated.rows;
    const Detection detection = detect(taken.image, board);
    EXPECT_FALSE(detection.found());
    EXPECT_NE(detection.reason.find("columns"), std::string::npos) << detection.reason;
    EXPECT_NE(detection.reason.find(seen), std::string::npos) << detection.reason;
}

// White that is clipped grows at black's cost, but evenly on both sides of a corner.
TEST(CalibrationCornerAccuracy, ClippedWhiteMovesNoCorner) {
    Taken taken = take(kBoard, perspective_camera(), {.tilt_deg = 30.0, .blur_px = 1.0});
    for (float& value : taken.image.pixels) {
        value = std::min(value, 0.75F);  // of a white of 0.9
    }
    const Errors e = errors(kBoard, taken);
    EXPECT_EQ(e.count, 54);
    EXPECT_LT(e.rms_px, 0.02);
}

// Corners a few pixels from the frame are measured with the part of their window that there is.
TEST(CalibrationCornerAccuracy, CornersNearTheFrameAreMeasured) {
    const Taken whole = take(kBoard, perspective_camera(), {.blur_px = 0.7, .noise = 0.005});
    const Detection detection = detect(whole.image, kBoard);
    ASSERT_TRUE(detection.found());
    const int cut = static_cast<int>(whole.truth_px[0].x) - 8;  // 8 px beside the first corner
    formats::Image image = formats::make_image(whole.image.width - cut, whole.image.height, {"Y"});
    ChartPoints start = detection.points;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            image.at(x, y, 0) = whole.image.at(x + cut, y, 0);
        }
    }
    for (Vec2d& point : start.image_px) {
        point.x -= cut;
    }
    const ChartPoints points = refine(image, 0, start, kBoard);
    ASSERT_TRUE(points.found[0]);
    EXPECT_NEAR(points.image_px[0].x + cut, whole.truth_px[0].x, 0.04);
    EXPECT_NEAR(points.image_px[0].y, whole.truth_px[0].y, 0.04);
}

}  // namespace lensproof::calibration::corner_accuracy_test
