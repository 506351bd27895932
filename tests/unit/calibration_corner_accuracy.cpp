#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "calibration/detect.h"
#include "calibration/refine.h"
#include "engine/scene/aruco.h"
#include "tests/unit/calibration_synthetic.h"

namespace lensproof {
namespace {

using namespace synthetic;

constexpr int kSamples = 6;  // 36 a pixel

struct Taken {
    Image image;
    std::vector<Vec2d> truth_px;
};

struct Shot {
    double tilt_deg = 0.0;
    double roll_deg = 4.0;
    double blur_px = 0.0;  // Gaussian, beside the pixel's own box
    double noise = 0.0;    // of white
    unsigned seed = 1;
    double distance_mm = 640.0;
    Vec2d aside_mm;
};

// One direction of a Gaussian blur; the frame's pixels go on without end.
void blur_along(Image& image, const std::vector<double>& kernel, int dx, int dy) {
    const Image source = image;
    const int reach = static_cast<int>(kernel.size()) - 1;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            double sum = 0.0;
            for (int k = -reach; k <= reach; ++k) {
                sum += kernel[std::abs(k)] * source.at(std::clamp(x + k * dx, 0, image.width - 1),
                                                       std::clamp(y + k * dy, 0, image.height - 1), 0);
            }
            image.at(x, y, 0) = static_cast<float>(sum);
        }
    }
}

void blur(Image& image, double sigma_px) {
    std::vector<double> kernel;
    double sum = 0.0;
    for (int k = 0; k <= std::ceil(4.0 * sigma_px); ++k) {
        kernel.push_back(std::exp(-0.5 * k * k / (sigma_px * sigma_px)));
        sum += (k == 0 ? 1.0 : 2.0) * kernel.back();
    }
    for (double& weight : kernel) {
        weight /= sum;
    }
    blur_along(image, kernel, 1, 0);
    blur_along(image, kernel, 0, 1);
}

Taken take(const Chart& chart, const CameraModel& camera, const Shot& shot) {
    constexpr double kDegree = std::numbers::pi / 180.0;
    const double tilt = shot.tilt_deg * kDegree;
    const Pose pose{{0.7 * tilt, -0.6 * tilt, shot.roll_deg * kDegree},
                    {shot.aside_mm.x, shot.aside_mm.y, shot.distance_mm}};
    Taken taken{.image = make_image(640, 480, {"Y"}), .truth_px = view_of(camera, pose, chart).image_px};
    paint(taken.image, 0, camera, pose, chart, kSamples);
    if (shot.blur_px > 0.0) {
        blur(taken.image, shot.blur_px);
    }
    add_noise(taken.image, shot.noise, shot.seed);
    return taken;
}

struct Errors {
    int seen = 0;
    int count = 0;
    Vec2d bias_px;
    double rms_px = 0.0;  // of one coordinate
    double worst_px = 0.0;
};

Errors errors(const Chart& chart, const Taken& taken) {
    Errors e;
    const Detection detection = detect(taken.image, chart);
    if (!detection.found()) {
        ADD_FAILURE() << detection.reason;
        return e;
    }
    e.seen = count_found(detection.points);
    const ChartPoints points = refine(taken.image, 0, detection.points, chart);
    for (std::size_t i = 0; i < points.found.size(); ++i) {
        if (points.found[i]) {
            const Vec2d d{points.image_px[i].x - taken.truth_px[i].x, points.image_px[i].y - taken.truth_px[i].y};
            e.bias_px = {e.bias_px.x + d.x, e.bias_px.y + d.y};
            e.rms_px += d.x * d.x + d.y * d.y;
            e.worst_px = std::max(e.worst_px, std::hypot(d.x, d.y));
            ++e.count;
        }
    }
    e.bias_px = {e.bias_px.x / e.count, e.bias_px.y / e.count};
    e.rms_px = std::sqrt(0.5 * e.rms_px / e.count);
    return e;
}

const Chart kBoard{.pattern = Checkerboard{10, 7, 30.0}};

Chart charuco_board() {
    const ArucoDictionary aruco = aruco_dictionary("DICT_4X4_50");
    return {.pattern = CharucoBoard{10, 7, 30.0, 22.0, aruco.cells, aruco.markers}};
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
    const Chart board = charuco_board();
    for (const Shot& shot :
         {Shot{}, Shot{.blur_px = 1.0, .noise = 0.01}, Shot{.tilt_deg = 40.0, .blur_px = 0.7, .noise = 0.01}}) {
        const Errors e = errors(board, take(board, perspective_camera(), shot));
        EXPECT_GE(e.count, 46);
        EXPECT_LT(std::abs(e.bias_px.x), 0.01);
        EXPECT_LT(std::abs(e.bias_px.y), 0.01);
        EXPECT_LT(e.rms_px, 0.02) << "tilt " << shot.tilt_deg;
    }
}

// A board that half leaves the frame: the corners in view are found, under their own numbers.
TEST(CalibrationCornerAccuracy, APartOfACharucoBoardCounts) {
    const Chart board = charuco_board();
    const Errors e =
        errors(board, take(board, perspective_camera(),
                           {.tilt_deg = 20.0, .noise = 0.01, .distance_mm = 400.0, .aside_mm = {90.0, -70.0}}));
    EXPECT_GE(e.count, 20);
    EXPECT_LT(e.seen, 50);
    EXPECT_LT(e.rms_px, 0.02);
}

// The markers number the corners whichever way the camera is turned.
TEST(CalibrationCornerAccuracy, ATurnedCharucoBoardKeepsItsNumbers) {
    const Chart board = charuco_board();
    for (const double roll_deg : {90.0, 180.0, -135.0}) {
        const Errors e = errors(board, take(board, perspective_camera(), {.roll_deg = roll_deg, .distance_mm = 800.0}));
        EXPECT_GE(e.count, 45);
        EXPECT_LT(e.worst_px, 0.1) << "roll " << roll_deg;
    }
}

TEST(CalibrationCornerAccuracy, ACharucoBoardBentByAFisheye) {
    const Chart board = charuco_board();
    const Errors e =
        errors(board, take(board, fisheye_camera(), {.tilt_deg = 8.0, .noise = 0.005, .distance_mm = 120.0}));
    EXPECT_GE(e.count, 40);
    EXPECT_LT(e.rms_px, 0.02);
}

TEST(CalibrationCornerAccuracy, AMirroredCharucoBoardIsSaidToBeOne) {
    const Chart board = charuco_board();
    Taken taken = take(board, perspective_camera(), {});
    for (int y = 0; y < taken.image.height; ++y) {
        for (int x = 0; x < taken.image.width / 2; ++x) {
            std::swap(taken.image.at(x, y, 0), taken.image.at(taken.image.width - 1 - x, y, 0));
        }
    }
    EXPECT_EQ(detect(taken.image, board).reason, "the board is seen mirrored");
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
    Image image = make_image(whole.image.width - cut, whole.image.height, {"Y"});
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

}  // namespace
}  // namespace lensproof
