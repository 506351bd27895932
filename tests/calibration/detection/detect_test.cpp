#include "calibration/detection/detect.h"

#include <gtest/gtest.h>

#include <limits>

#include "calibration/detection/refine.h"
#include "engine/base/input_error.h"
#include "tests/calibration/synthetic.h"
#include "tests/complaint.h"

namespace lensproof::calibration::detect_test {

using namespace synthetic;

const scene::Chart kBoard{.pattern = scene::Checkerboard{10, 7, 30.0}};
const scene::Chart kDiscs{.pattern = scene::DiscGrid{8, 6, 40.0, 20.0}};
constexpr int kSamples = 6;  // 36 a pixel: every edge is placed to 1/36 px or better

formats::Image picture(const CameraModel& camera, const Pose& pose, const scene::Chart& chart, double noise,
                       double brightness = 1.0) {
    formats::Image image = formats::make_image(640, 480, {"Y"});
    paint(image, 0, camera, pose, chart, kSamples, [=](const Vec2d&) { return brightness; });
    add_noise(image, noise * brightness, 11);
    return image;
}

struct Comparison {
    int found = 0;
    double rms = 0.0;
    double worst = 0.0;
};

// Detected and refined points of a picture against the exact ones: of discs, the centroids of their images.
Comparison compare(const CameraModel& camera, const Pose& pose, const scene::Chart& chart, double noise,
                   double brightness = 1.0) {
    const formats::Image image = picture(camera, pose, chart, noise, brightness);
    const std::vector<Vec2d> features = scene::feature_points(chart);
    const Detection detection = detect(image, chart);
    if (!detection.found()) {
        return {};
    }
    const ChartPoints points = refine(image, 0, detection.points, chart);
    Comparison result;
    for (std::size_t i = 0; i < features.size(); ++i) {
        if (points.found[i]) {
            const Vec2d expected = predict(camera, pose, features[i], disc_diameter_mm(chart)).value();
            const double error = std::hypot(points.image_px[i].x - expected.x, points.image_px[i].y - expected.y);
            result.rms += error * error;
            result.worst = std::max(result.worst, error);
            ++result.found;
        }
    }
    result.rms = std::sqrt(result.rms / result.found);
    return result;
}

// The bar for a corner is 0.05 px rms: a tenth of what a distortion of 0.1 % moves a point at 500 px.
TEST(CalibrationDetect, CornersOfATiltedBoardAreWithinATwentiethOfAPixel) {
    const BrownConrady camera = perspective_camera();
    for (const Pose& pose : tilted_poses(600.0, 0.35, 30.0)) {
        const Comparison c = compare(camera, pose, kBoard, 0.01);
        EXPECT_EQ(c.found, 54);
        EXPECT_LT(c.rms, 0.05);
    }
}

// A board that fills a fisheye's view is bent too much for straight-line detectors.
TEST(CalibrationDetect, CornersOfABoardBentByAFisheye) {
    const KannalaBrandt camera = fisheye_camera();
    for (const double distance : {150.0, 110.0}) {
        const Pose pose{{0.1, -0.15, 0.02}, {5.0, -4.0, distance}};
        const Comparison c = compare(camera, pose, kBoard, 0.005);
        EXPECT_GE(c.found, 50);
        EXPECT_LT(c.rms, 0.05);
    }
}

// A thousandth of full scale is a usable picture in linear light.
TEST(CalibrationDetect, ADarkPictureIsNoObstacle) {
    const BrownConrady camera = perspective_camera();
    const Pose pose{{0.2, 0.3, 0.0}, {0.0, 0.0, 600.0}};
    const Comparison c = compare(camera, pose, kBoard, 0.005, 1e-3);
    EXPECT_EQ(c.found, 54);
    EXPECT_LT(c.rms, 0.05);
}

// The board's colours tell its top left corner, whichever way the camera is turned (10 + 7 squares: odd).
TEST(CalibrationDetect, TheBlackSquareNamesTheFirstCorner) {
    const BrownConrady camera = perspective_camera();
    for (const double roll : {0.0, 1.5, 3.1, -1.6}) {
        const Pose pose{{0.0, 0.0, roll}, {0.0, 0.0, 700.0}};
        const Comparison c = compare(camera, pose, kBoard, 0.0);
        EXPECT_GT(c.found, 45);
        EXPECT_LT(c.worst, 0.3) << "roll " << roll;
    }
}

// A square board of an odd and a board of an even number of squares look the same after a half turn: rows run right.
TEST(CalibrationDetect, SymmetricBoardsAreNumberedUpright) {
    const BrownConrady camera = perspective_camera();
    for (const scene::Chart& chart : {scene::Chart{.pattern = scene::Checkerboard{9, 7, 30.0}},
                                      scene::Chart{.pattern = scene::Checkerboard{7, 7, 30.0}}}) {
        const Pose pose{{0.0, 0.1, 0.2}, {0.0, 0.0, 700.0}};
        const Comparison c = compare(camera, pose, chart, 0.0);
        EXPECT_GT(c.found, 30);
        EXPECT_LT(c.worst, 0.3);
    }
}

// Centroids of discs, which perspective and distortion move by far more than 0.05 px from the images of the centres.
TEST(CalibrationDetect, DiscCentroidsAreWithinATwentiethOfAPixel) {
    const BrownConrady camera = perspective_camera();
    for (const Pose& pose : {Pose{{0.0, 0.0, 0.0}, {0.0, 0.0, 700.0}}, Pose{{0.3, -0.4, 0.1}, {0.0, 0.0, 750.0}}}) {
        const Comparison c = compare(camera, pose, kDiscs, 0.01);
        EXPECT_GE(c.found, 46);
        EXPECT_LT(c.rms, 0.05);
    }
}

TEST(CalibrationDetect, DiscsInAFisheye) {
    const KannalaBrandt camera = fisheye_camera();
    const Pose pose{{0.05, -0.1, 0.02}, {5.0, -4.0, 160.0}};
    const Comparison c = compare(camera, pose, kDiscs, 0.005);
    EXPECT_GE(c.found, 40);
    EXPECT_LT(c.rms, 0.05);
}

TEST(CalibrationDetect, NothingIsFoundWhereNothingIs) {
    EXPECT_FALSE(detect(formats::Image{}, kBoard).found());
    EXPECT_FALSE(detect(formats::make_image(1, 1, {"R", "G", "B"}), kBoard).found());
    EXPECT_FALSE(detect(formats::make_image(640, 480, {"Y"}), kBoard).found());
    formats::Image grey = formats::make_image(320, 240, {"Y"});
    std::fill(grey.pixels.begin(), grey.pixels.end(), 0.5F);
    EXPECT_FALSE(detect(grey, kBoard).found());
    EXPECT_FALSE(detect(grey, kDiscs).found());
    add_noise(grey, 0.1, 4);
    EXPECT_FALSE(detect(grey, kBoard).found());
    EXPECT_FALSE(detect(grey, kDiscs).found());
    std::fill(grey.pixels.begin(), grey.pixels.end(), std::numeric_limits<float>::quiet_NaN());
    EXPECT_FALSE(detect(grey, kBoard).found());
    EXPECT_THROW(detect(grey, scene::Chart{.pattern = scene::FlatField{}}), InputError);
    EXPECT_THROW(detect(grey, scene::Chart{.pattern = scene::AstigmatismCrosses{9, 7, 20.0, 10.0, 1.0}}), InputError);
    EXPECT_THROW(detect(grey, scene::Chart{.pattern = scene::Checkerboard{2, 2, 30.0}}), InputError);
}

// A picture without the chart says why, in words that a photographer can act on.
TEST(CalibrationDetect, AChartNotFoundHasItsReason) {
    EXPECT_NE(detect(formats::make_image(1, 1, {"Y"}), kBoard).reason.find("too small"), std::string::npos);
    EXPECT_NE(detect(formats::make_image(64, 48, {"Y"}), kBoard).reason.find("no contrast"), std::string::npos);
    formats::Image noise = formats::make_image(64, 48, {"Y"});
    add_noise(noise, 0.1, 4);
    EXPECT_EQ(detect(noise, kBoard).reason, "no checkerboard of 9 × 6 inner corners found");
    EXPECT_EQ(detect(noise, kDiscs).reason, "no grid of 8 × 6 discs found");
}

// The board has 10 × 7 squares. Most of OpenCV's detectors would take a part of it for a smaller chart.
TEST(CalibrationDetect, ABoardOfAnotherCountIsNamed) {
    const BrownConrady camera = perspective_camera();
    const auto reason = [](const formats::Image& image, int columns, int rows) {
        return detect(image, {.pattern = scene::Checkerboard{columns, rows, 30.0}}).reason;
    };
    const std::string lying = "9 × 6 inner corners (squares = [10, 7]) found";
    for (const Pose& pose : tilted_poses(600.0, 0.35, 30.0)) {
        const formats::Image image = picture(camera, pose, kBoard, 0.002);
        EXPECT_TRUE(says(reason(image, 9, 7), lying));
        EXPECT_TRUE(says(reason(image, 8, 7), lying));
        EXPECT_TRUE(says(reason(image, 8, 5), lying));
        EXPECT_TRUE(says(reason(image, 6, 9), "6 × 9 inner corners (squares = [7, 10]) found"));
        EXPECT_EQ(reason(image, 7, 10), "");
    }
    EXPECT_TRUE(says(reason(picture(camera, tilted_poses(600.0, 0.35, 30.0).front(), kBoard, 0.002), 11, 7), lying));
}

// What cannot be measured is said to be missing: a corner under a NaN, one painted over, one at the picture's edge.
TEST(CalibrationDetect, SpoiledCornersAreMissing) {
    const BrownConrady camera = perspective_camera();
    const Pose pose{{0.1, 0.1, 0.0}, {0.0, 0.0, 600.0}};
    formats::Image image = picture(camera, pose, kBoard, 0.0);
    std::vector<Vec2d> points = view_of(camera, pose, kBoard).image_px;
    const std::vector<bool> all(points.size(), true);
    image.at(static_cast<int>(points[10].x), static_cast<int>(points[10].y), 0) = std::nanf("");
    for (int y = -15; y <= 15; ++y) {
        for (int x = -15; x <= 15; ++x) {
            image.at(static_cast<int>(points[30].x) + x, static_cast<int>(points[30].y) + y, 0) = 0.4F;
        }
    }
    points[0] = {1.0, 1.0};
    const ChartPoints refined = refine(image, 0, {points, all}, kBoard);
    EXPECT_FALSE(refined.found[10]);
    EXPECT_FALSE(refined.found[30]);
    EXPECT_FALSE(refined.found[0]);
    EXPECT_GE(count_found(refined), 49);
    EXPECT_THROW(refine(image, 0, {}, kBoard), InputError);
    EXPECT_THROW(refine(image, 3, {points, all}, kBoard), InputError);
}

}  // namespace lensproof::calibration::detect_test
