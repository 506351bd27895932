#include "calibration/geometry/fit_geometry.h"

#include <gtest/gtest.h>

#include <numbers>

#include "calibration/detection/disc_centroid.h"
#include "engine/base/angle.h"
#include "engine/base/input_error.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::fit_geometry_test {

using namespace synthetic;

const scene::Chart kBoard{.pattern = scene::Checkerboard{10, 7, 30.0}};
constexpr int kWidth = 640;
constexpr int kHeight = 480;

std::vector<ChartView> views_of(const CameraModel& camera, const std::vector<Pose>& poses,
                                const scene::Chart& chart = kBoard) {
    std::vector<ChartView> views;
    views.reserve(poses.size());
    for (const Pose& pose : poses) {
        views.push_back(view_of(camera, pose, chart));
    }
    return views;
}

void add_noise(std::vector<ChartView>& views, double sigma, Noise& noise) {
    for (ChartView& view : views) {
        for (Vec2d& p : view.image_px) {
            p.x += sigma * noise();
            p.y += sigma * noise();
        }
    }
}

GeometryOptions options_for(ModelKind kind) {
    GeometryOptions options;
    options.model = kind;
    return options;
}

// Exact projections leave only rounding: 1e-12 px in the points, times the conditioning of the worst parameter.
TEST(CalibrationGeometry, ExactViewsGiveBackThePerspectiveCamera) {
    const BrownConrady truth = perspective_camera();
    const auto poses = tilted_poses(600.0, 0.4, 60.0);
    const GeometryFit fit =
        fit_geometry(views_of(truth, poses), kWidth, kHeight, options_for(ModelKind::brown_conrady));
    for (std::size_t i = 0; i < truth.parameters.size(); ++i) {
        EXPECT_NEAR(parameters(fit.model)[i], truth.parameters[i], 1e-6) << BrownConrady::names[i];
    }
    EXPECT_LT(fit.rms_px, 1e-8);
    EXPECT_EQ(fit.points_used, 5 * 54);
    for (std::size_t v = 0; v < poses.size(); ++v) {
        EXPECT_LT(length(fit.views[v].pose.translation_mm - poses[v].translation_mm), 1e-5);
        EXPECT_LT(length(fit.views[v].pose.rotation_rad - poses[v].rotation_rad), 1e-7);
    }
}

// The same for a fisheye whose views reach beyond 90° from the axis.
TEST(CalibrationGeometry, ExactViewsGiveBackTheFisheyeBeyond90Degrees) {
    const KannalaBrandt truth = fisheye_camera();
    auto poses = tilted_poses(170.0, 0.3, 40.0);
    const double side = radians(80.0);
    poses.push_back({{0.0, -side, 0.0}, {200.0 * std::sin(-side) * -1.0, 0.0, 200.0 * std::cos(side)}});
    poses.push_back({{0.0, side, 0.0}, {-200.0 * std::sin(side), 0.0, 200.0 * std::cos(side)}});
    const auto views = views_of(truth, poses);
    double widest = 0.0;
    for (const ChartView& view : views) {
        for (const Vec2d& pixel : view.image_px) {
            widest =
                std::max(widest, field_angle_rad(truth, std::hypot(pixel.x - 322.0, pixel.y - 236.0)).value_or(0.0));
        }
    }
    ASSERT_GT(widest, radians(95.0));
    const GeometryFit fit = fit_geometry(views, kWidth, kHeight, options_for(ModelKind::kannala_brandt));
    for (std::size_t i = 0; i < truth.parameters.size(); ++i) {
        EXPECT_NEAR(parameters(fit.model)[i], truth.parameters[i], 1e-6) << KannalaBrandt::names[i];
    }
}

// Moving a point by 20 px must not move the camera: the point is left out and said to be.
TEST(CalibrationGeometry, AWrongPointIsLeftOut) {
    const BrownConrady truth = perspective_camera();
    auto views = views_of(truth, tilted_poses(600.0, 0.4, 60.0));
    views[2].image_px[17].x += 20.0;
    const GeometryFit fit = fit_geometry(views, kWidth, kHeight, options_for(ModelKind::brown_conrady));
    EXPECT_FALSE(fit.views[2].residuals[17].used);
    EXPECT_NEAR(fit.views[2].residuals[17].measured_minus_model_px.x, 20.0, 1e-5);
    EXPECT_EQ(fit.points_used, 5 * 54 - 1);
    EXPECT_NEAR(focal_length_px(fit.model), truth.parameters[0], 1e-5);
}

// A chart that faces the camera looks the same from twice as far with twice the focal length.
TEST(CalibrationGeometry, OneViewFromTheFrontDoesNotTellTheFocalLength) {
    const BrownConrady truth{{820.0, 319.5, 239.5, -0.2, 0.0, 0.0, 0.0, 0.0}};
    auto views = views_of(truth, {Pose{{0.0, 0.0, 0.0}, {0.0, 0.0, 600.0}}});
    Noise noise(3);
    add_noise(views, 0.05, noise);
    GeometryOptions options = options_for(ModelKind::brown_conrady);
    options.fix_centre = true;
    options.fit_tangential = false;
    options.radial_terms = 1;
    EXPECT_THROW(fit_geometry(views, kWidth, kHeight, options), InputError);
    options.known_focal_px = 820.0;
    const GeometryFit fit = fit_geometry(views, kWidth, kHeight, options);
    EXPECT_EQ(focal_length_px(fit.model), 820.0);
    EXPECT_EQ(fit.standard_error(0), 0.0);
    EXPECT_NEAR(parameters(fit.model)[3], -0.2, 5.0 * fit.standard_error(3));
}

TEST(CalibrationGeometry, UnusableViewsAreRefused) {
    const GeometryOptions options;
    EXPECT_THROW(fit_geometry({}, kWidth, kHeight, options), InputError);
    EXPECT_THROW(fit_geometry({ChartView{}}, kWidth, kHeight, options), InputError);
    auto views = views_of(perspective_camera(), tilted_poses(600.0, 0.4, 60.0));
    EXPECT_THROW(fit_geometry(views, 0, kHeight, options), InputError);
    EXPECT_THROW(fit_geometry({ChartView{"line",
                                         {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}, {6, 0}, {7, 0}, {8, 0}},
                                         {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}, {6, 0}, {7, 0}, {8, 0}}}},
                              kWidth, kHeight, options),
                 InputError);
    views[1].image_px[3].y = std::nan("");
    EXPECT_THROW(fit_geometry(views, kWidth, kHeight, options), InputError);
}

// A pinhole images a disc as an ellipse, whose centre has a closed form: for the disc of radius R about (x0, 0) on a
// plane Z = Z0 + t x (tilt t = tan), (u) = f x / Z has its ends at x0 ± R, so the ellipse's centre is the mean of the
// two. The 12-gon's centroid must agree to fourth order in R / Z, here (20/600)² of the eccentricity itself.
TEST(CalibrationGeometry, CentroidOfADiscIsTheCentreOfItsEllipse) {
    constexpr double f = 1000.0;
    constexpr double tilt = 0.6;
    constexpr double z0 = 600.0;
    constexpr double x0 = 100.0;
    constexpr double radius = 20.0;
    const auto image = [&](double x) { return f * x / (z0 + tilt * x); };
    const auto map = [&](double x, double y, Vec2d& pixel) {
        pixel = {f * x / (z0 + tilt * x), f * y / (z0 + tilt * x)};
        return true;
    };
    Vec2d centroid;
    ASSERT_TRUE(disc_centroid(map, x0, 0.0, 2.0 * radius, centroid));
    const double eccentricity = 0.5 * (image(x0 - radius) + image(x0 + radius)) - image(x0);
    ASSERT_GT(std::abs(eccentricity), 0.5);
    EXPECT_NEAR(centroid.x - image(x0), eccentricity, 5e-3 * std::abs(eccentricity));
    EXPECT_NEAR(centroid.y, 0.0, 1e-12);
}

// Centroids that are taken for images of centres bias the camera; the option removes it. The centroids here come from
// 20 000 points spread evenly over each disc, weighted by the image's local area.
TEST(CalibrationGeometry, DiscCentroidsAreModelled) {
    const scene::Chart discs{.pattern = scene::DiscGrid{8, 6, 40.0, 24.0}};
    const BrownConrady truth = perspective_camera();
    std::vector<ChartView> views;
    for (const Pose& pose : tilted_poses(600.0, 0.6, 40.0)) {
        ChartView view{.name = "discs", .chart_mm = scene::feature_points(discs), .image_px = {}};
        for (const Vec2d& centre : view.chart_mm) {
            double mass = 0.0;
            Vec2d moment;
            constexpr int rings = 40;
            constexpr int spokes = 64;
            for (int i = 0; i < rings; ++i) {
                for (int j = 0; j < spokes; ++j) {
                    const double r = 12.0 * std::sqrt((i + 0.5) / rings);
                    const double azimuth = 2.0 * std::numbers::pi * (j + 0.5) / spokes;
                    const Vec2d point{centre.x + r * std::cos(azimuth), centre.y + r * std::sin(azimuth)};
                    const auto at = [&](double dx, double dy) {
                        return project(truth, to_camera(pose, {point.x + dx, point.y + dy})).value();
                    };
                    const Vec2d px = at(0, 0);
                    const Vec2d e = at(1e-3, 0);
                    const Vec2d s = at(0, 1e-3);
                    const double area = (e.x - px.x) * (s.y - px.y) - (e.y - px.y) * (s.x - px.x);
                    mass += area;
                    moment.x += area * px.x;
                    moment.y += area * px.y;
                }
            }
            view.image_px.push_back({moment.x / mass, moment.y / mass});
        }
        views.push_back(view);
    }
    GeometryOptions options = options_for(ModelKind::brown_conrady);
    options.disc_diameter_mm = 24.0;
    const GeometryFit modelled = fit_geometry(views, kWidth, kHeight, options);
    options.disc_diameter_mm = 0.0;
    const GeometryFit ignored = fit_geometry(views, kWidth, kHeight, options);
    EXPECT_LT(modelled.rms_px, 2e-3);
    EXPECT_NEAR(focal_length_px(modelled.model), 820.0, 0.05);
    EXPECT_GT(ignored.rms_px, 10.0 * modelled.rms_px);
}

}  // namespace lensproof::calibration::fit_geometry_test
