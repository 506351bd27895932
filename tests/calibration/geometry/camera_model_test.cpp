#include "calibration/geometry/camera_model.h"

#include <gtest/gtest.h>

#include "engine/base/angle.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::camera_model_test {

Vec3d direction(double angle, double azimuth) {
    return {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle)};
}

// Without distortion Brown's model is the pinhole, f tan θ, and Kannala and Brandt's the equidistant lens, f θ.
TEST(CalibrationCameraModel, UndistortedModelsAreTheTextbookProjections) {
    const BrownConrady pinhole{{1000.0, 500.0, 400.0, 0, 0, 0, 0, 0}};
    const KannalaBrandt equidistant{{1000.0, 500.0, 400.0, 0, 0, 0, 0}};
    const auto a = project(CameraModel(pinhole), {0.3, -0.4, 1.0});
    ASSERT_TRUE(a);
    EXPECT_DOUBLE_EQ(a->x, 800.0);
    EXPECT_DOUBLE_EQ(a->y, 0.0);
    const auto b = project(CameraModel(equidistant), direction(100.0 * kDegree, 0.0));
    ASSERT_TRUE(b);
    EXPECT_NEAR(b->x, 500.0 + 1000.0 * 100.0 * kDegree, 1e-9);
    EXPECT_NEAR(b->y, 400.0, 1e-9);
}

// The table is linear between quarters of a pixel: within 8e-3 θ'' (here at most 1.2 / f² of either lens), and none
// where the model has none. At r = 0 and at its own radii it is exact.
TEST(CalibrationCameraModel, ATableOfAnglesIsTheAngles) {
    const CameraModel models[] = {synthetic::perspective_camera(), synthetic::fisheye_camera()};
    for (const CameraModel& model : models) {
        const FieldAngles table(model, 500.0);
        const double bound = 8e-3 * 1.2 / std::pow(focal_length_px(model), 2);
        for (double radius = 0.0; radius < 400.0; radius += 1.37) {
            const auto exact = field_angle_rad(model, radius);
            ASSERT_EQ(exact.has_value(), table.at(radius).has_value()) << radius;
            if (exact) {
                EXPECT_NEAR(*table.at(radius), *exact, bound) << radius;
            }
        }
        EXPECT_EQ(table.at(100.25), field_angle_rad(model, 100.25));
        EXPECT_FALSE(table.at(501.0));
        EXPECT_FALSE(table.at(-1.0));
        const Vec2d pixel = centre_px(model) + Vec2d{120.0, -75.0};
        EXPECT_LT(length(*unproject(model, pixel, table) - *unproject(model, pixel)), bound);
    }
}

// Every direction inside the first fold comes back from its pixel. A pixel is good to 1e-13 px (ulp of 600), a radian
// to that over the focal length times the slope; 1e-11 leaves two digits for a slope of 1/10.
TEST(CalibrationCameraModel, UnprojectInvertsProject) {
    const CameraModel models[] = {synthetic::perspective_camera(), synthetic::fisheye_camera()};
    const double last_angle[] = {35.0 * kDegree, 110.0 * kDegree};
    for (int m = 0; m < 2; ++m) {
        for (double azimuth = 0.0; azimuth < 6.2; azimuth += 0.7) {
            for (double fraction = 0.0; fraction <= 1.0; fraction += 0.05) {
                const Vec3d ray = direction(fraction * last_angle[m], azimuth);
                const auto pixel = project(models[m], ray);
                ASSERT_TRUE(pixel);
                const auto back = unproject(models[m], *pixel);
                ASSERT_TRUE(back) << kind_name(models[m]) << " at " << fraction * last_angle[m] / kDegree;
                EXPECT_LT(length(*back - ray), 1e-11);
            }
        }
    }
}

// Near the axis r = f θ for every model; the next term is θ² smaller.
TEST(CalibrationCameraModel, FocalLengthIsTheSlopeOnTheAxis) {
    for (const CameraModel& model :
         {CameraModel(synthetic::perspective_camera()), CameraModel(synthetic::fisheye_camera())}) {
        EXPECT_NEAR(radius_px(model, 1e-4) / 1e-4, focal_length_px(model), 1e-7 * focal_length_px(model));
    }
}

// r(θ) = f (θ − θ³/3) folds back at θ = 1, r = 2/3 f: beyond that no direction is imaged.
TEST(CalibrationCameraModel, NothingIsImagedBeyondTheFold) {
    const CameraModel folding = KannalaBrandt{{300.0, 0.0, 0.0, -1.0 / 3.0, 0, 0, 0}};
    EXPECT_TRUE(field_angle_rad(folding, 199.99));
    EXPECT_FALSE(field_angle_rad(folding, 200.01));
    EXPECT_FALSE(field_angle_rad(folding, -1.0));
    EXPECT_FALSE(field_angle_rad(folding, std::nan("")));
    EXPECT_FALSE(unproject(folding, {1e6, 0.0}));
}

TEST(CalibrationCameraModel, PerspectiveImagesNothingBehindTheCamera) {
    EXPECT_FALSE(project(CameraModel(synthetic::perspective_camera()), {0.1, 0.0, 0.0}));
    EXPECT_FALSE(project(CameraModel(synthetic::perspective_camera()), {0.1, 0.0, -1.0}));
    EXPECT_FALSE(project(CameraModel(synthetic::fisheye_camera()), {0.0, 0.0, -1.0}));
    EXPECT_TRUE(project(CameraModel(synthetic::fisheye_camera()), {1.0, 0.0, -0.2}));
}

}  // namespace lensproof::calibration::camera_model_test
