// The lens models against what their names promise.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "calibration/geometry/fit_geometry.h"
#include "engine/base/angle.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::lens_models_test {

CameraModel model_of(const std::string& kind, const std::vector<double>& values) {
    return with_parameters(empty_model(model_kind(kind).value()), values);
}

// A camera of every kind with a few percent of distortion; its largest angle that is tested.
struct Case {
    CameraModel model;
    double last_angle;
};

std::vector<Case> every_model() {
    return {{model_of("brown-conrady", {800, 320, 240, -0.2, 0.05, -0.01, 0.001, -0.0005}), 35 * kDegree},
            {model_of("brown-conrady-rational", {300, 320, 240, 0.3, 0.02, 0.0, 0.001, -0.0005, 0.5, 0.08, 0.01}),
             50 * kDegree},
            {model_of("division", {300, 320, 240, -0.22}), 115 * kDegree},
            {model_of("division", {800, 320, 240, 0.1}), 50 * kDegree},
            {model_of("poly3", {800, 320, 240, -0.05, 239.5}), 40 * kDegree},
            {model_of("poly5", {800, 320, 240, -0.05, 0.01, 239.5}), 40 * kDegree},
            {model_of("ptlens", {800, 320, 240, -0.03, 0.01, 0.005, 239.5}), 40 * kDegree},
            {model_of("kannala-brandt", {220, 320, 240, -0.012, 0.004, -0.002, 0.0002}), 110 * kDegree},
            {model_of("equidistant", {220, 320, 240, -0.01, 0.001}), 110 * kDegree},
            {model_of("equisolid", {220, 320, 240, 0.01, 0.001}), 110 * kDegree},
            {model_of("stereographic", {220, 320, 240, -0.01, 0.001}), 110 * kDegree},
            {model_of("orthographic", {220, 320, 240, 0.02, 0.001}), 80 * kDegree},
            {model_of("spline", {220, 320, 240, 0.0, -0.001, -0.003, -0.006, -0.01, -0.014, -0.018, -0.023, -0.03,
                                 -0.04, -0.05, 100 * kDegree}),
             110 * kDegree}};
}

Vec3d direction(double angle, double azimuth) {
    return {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle)};
}

TEST(CalibrationLensModels, EveryKindHasACase) {
    std::size_t kinds = 1;  // division twice
    for (const Case& c : every_model()) {
        kinds += c.model.index() == static_cast<std::size_t>(ModelKind::division) ? 0 : 1;
        EXPECT_EQ(model_kind(kind_name(c.model)), kind(c.model));
        EXPECT_EQ(parameters(c.model).size(), parameter_names(c.model).size());
    }
    EXPECT_EQ(kinds, model_kind_names().size());
    EXPECT_FALSE(model_kind("auto"));
}

// A direction comes back from its pixel to 1e-11, as for the first two models (calibration_camera_model.cpp).
TEST(CalibrationLensModels, UnprojectInvertsProject) {
    std::vector<Case> cases = every_model();
    for (Case stretched : every_model()) {
        std::vector<double> values = parameters(stretched.model);
        values.back() = 0.02;
        stretched.model = with_parameters(stretched.model, values);
        cases.push_back(stretched);
    }
    for (const Case& c : cases) {
        for (double azimuth = 0.0; azimuth < 6.2; azimuth += 0.9) {
            for (double fraction = 0.0; fraction <= 1.0; fraction += 0.05) {
                const Vec3d ray = direction(fraction * c.last_angle, azimuth);
                const auto pixel = project(c.model, 7.0 * ray);
                ASSERT_TRUE(pixel) << kind_name(c.model) << " at " << fraction * c.last_angle / kDegree;
                const auto back = unproject(c.model, *pixel);
                ASSERT_TRUE(back) << kind_name(c.model) << " at " << fraction * c.last_angle / kDegree;
                EXPECT_LT(length(*back - ray), 1e-11) << kind_name(c.model);
            }
        }
    }
}

// r = f θ near the axis; the next term is θ² smaller, θ for ptlens's odd one (c = 0.005 at 240 px: 1e-6 at 1e-4).
TEST(CalibrationLensModels, TheFirstParameterIsTheSlopeOnTheAxis) {
    for (const Case& c : every_model()) {
        EXPECT_NEAR(radius_px(c.model, 1e-4) / (1e-4 * focal_length_px(c.model)), 1.0, 3e-6) << kind_name(c.model);
    }
}

// Without distortion each family is the textbook's formula; each model's undistorted angle is its inverse.
TEST(CalibrationLensModels, UndistortedFamiliesAreTheirFormulas) {
    for (const double angle : {0.1, 0.7, 1.3}) {
        const double ideal[] = {angle, 2 * std::sin(angle / 2), 2 * std::tan(angle / 2), std::sin(angle)};
        int i = 0;
        for (const char* name : {"equidistant", "equisolid", "stereographic", "orthographic"}) {
            const CameraModel model = model_of(name, {100, 0, 0, 0, 0});
            EXPECT_NEAR(radius_px(model, angle), 100 * ideal[i], 1e-11) << name;
            EXPECT_NEAR(undistorted_angle_rad(kind(model), 100, 100 * ideal[i++]), angle, 1e-12) << name;
        }
    }
}

// Fitzgibbon's model with λ = −1/4 is the stereographic projection, 2 f tan(θ/2): from tan θ = 2 t / (1 − t²).
TEST(CalibrationLensModels, DivisionByAQuarterIsStereographic) {
    const CameraModel division = model_of("division", {300, 0, 0, -0.25});
    for (const double angle : {0.01, 0.5, 1.5, 2.5}) {
        EXPECT_NEAR(radius_px(division, angle), 600.0 * std::tan(0.5 * angle), 1e-9);
    }
    // With λ > 0 nothing is imaged beyond tan θ = 1 / (2 √λ), here 1.
    const CameraModel pincushion = model_of("division", {300, 0, 0, 0.25});
    EXPECT_TRUE(project(pincushion, direction(44.9 * kDegree, 0.3)));
    EXPECT_FALSE(project(pincushion, direction(45.1 * kDegree, 0.3)));
    EXPECT_FALSE(project(pincushion, direction(100.0 * kDegree, 0.3)));
}

// lensfun's formulas, written here in its own terms: its focal length F and radii in units of half the short side.
TEST(CalibrationLensModels, LensfunsModelsAreItsFormulas) {
    constexpr double r = 499.5;  // a picture of 1500 × 1000
    constexpr double big_f = 900.0;
    constexpr double a = 0.012, b = -0.045, c = 0.007, k1 = -0.03, k2 = 0.006;
    const CameraModel poly3 = model_of("poly3", {big_f * (1 - k1), 0, 0, k1, r});
    const CameraModel poly5 = model_of("poly5", {big_f, 0, 0, k1, k2, r});
    const CameraModel ptlens = model_of("ptlens", {big_f * (1 - a - b - c), 0, 0, b, a, c, r});
    for (const double angle : {0.05, 0.3, 0.6}) {
        const double u = big_f * std::tan(angle) / r;
        EXPECT_NEAR(radius_px(poly3, angle), r * u * (1 - k1 + k1 * u * u), 1e-10);
        EXPECT_NEAR(radius_px(poly5, angle), r * u * (1 + k1 * u * u + k2 * u * u * u * u), 1e-10);
        EXPECT_NEAR(radius_px(ptlens, angle), r * u * (a * u * u * u + b * u * u + c * u + 1 - a - b - c), 1e-10);
    }
}

// OpenCV is the judge of Brown and Conrady's 5 and 8 coefficients (its order: k1, k2, p1, p2, k3, k4, k5, k6).
TEST(CalibrationLensModels, BrownConradyIsOpenCvs) {
    const CameraModel model =
        model_of("brown-conrady-rational", {800, 320, 240, 0.3, 0.02, 0.004, 0.001, -0.0005, 0.5, 0.08, 0.01});
    const std::vector<double> coefficients{0.3, 0.02, 0.001, -0.0005, 0.004, 0.5, 0.08, 0.01};
    const cv::Matx33d camera(800, 0, 320, 0, 800, 240, 0, 0, 1);
    const std::vector<cv::Point3d> points{{0.4, -0.3, 1.0}, {-0.6, 0.5, 1.2}, {0.1, 0.9, 1.0}};
    std::vector<cv::Point2d> expected;
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), camera, coefficients, expected);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto pixel = project(model, {points[i].x, points[i].y, points[i].z}).value();
        EXPECT_NEAR(pixel.x, expected[i].x, 1e-10);
        EXPECT_NEAR(pixel.y, expected[i].y, 1e-10);
    }
}

// Exact views give every model back: the mapping to 1e-4 px over the heights seen (parameters of a rational function
// are less well conditioned than what they say). A fitted spline has its knots elsewhere, which costs 0.01 px.
TEST(CalibrationLensModels, ExactViewsGiveBackEveryModel) {
    const scene::Chart board{.pattern = scene::Checkerboard{9, 8, 30.0}};
    for (const Case& c : every_model()) {
        const double focal = focal_length_px(c.model);
        std::vector<ChartView> views;
        for (const Pose& pose : synthetic::tilted_poses(focal > 500.0 ? 500.0 : 200.0, 0.4, 40.0)) {
            views.push_back(synthetic::view_of(c.model, pose, board));
        }
        GeometryOptions options;
        options.model = kind(c.model);
        const GeometryFit fit = fit_geometry(views, 640, 480, options);
        const double tolerance_px = kind(c.model) == ModelKind::spline ? 0.01 : 1e-4;
        EXPECT_LT(fit.rms_px, tolerance_px) << kind_name(c.model);
        for (const double r : {50.0, 120.0, 200.0}) {
            const auto truth = field_angle_rad(c.model, r);
            const auto found = field_angle_rad(fit.model, r);
            ASSERT_TRUE(truth && found) << kind_name(c.model);
            EXPECT_NEAR(*found, *truth, tolerance_px / focal) << kind_name(c.model) << " at " << r;
        }
    }
}

// The spline is twice continuously differentiable across its knots: the second difference quotients on both sides
// approach each other in proportion to h, while a jump of the second derivative would stay. Rounding is 1e-6 px.
TEST(CalibrationLensModels, TheSplineIsSmoothAcrossItsKnots) {
    const CameraModel spline = every_model().back().model;
    const auto jump = [&](double t, double h) {
        const auto second = [&](double at) {
            return (radius_px(spline, at + h) - 2 * radius_px(spline, at) + radius_px(spline, at - h)) / (h * h);
        };
        return std::abs(second(t + 1.01 * h) - second(t - 1.01 * h));
    };
    for (int knot = 1; knot <= 10; ++knot) {
        const double t = knot * 10.0 * kDegree;
        EXPECT_LT(jump(t, 5e-4), 0.3 * jump(t, 2e-3) + 1e-5) << knot;
        EXPECT_GT(jump(t, 2e-3), 0.0);
    }
}

}  // namespace lensproof::calibration::lens_models_test
