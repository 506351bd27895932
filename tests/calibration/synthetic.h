// Pictures and views of charts through a known camera, for the tests of calibration/.
#pragma once
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "calibration/geometry/camera_model.h"
#include "calibration/geometry/fit_geometry.h"
#include "calibration/geometry/planar_pose.h"
#include "calibration/self_test/chart_point.h"
#include "engine/formats/image/image.h"
#include "engine/scene/chart/chart.h"

namespace lensproof::calibration::synthetic {

inline BrownConrady perspective_camera() {
    return {{820.0, 318.5, 243.0, -0.24, 0.09, -0.01, 0.0008, -0.0005}};
}

/// Covers 105° at the corners of 640 × 480.
inline KannalaBrandt fisheye_camera() {
    return {{220.0, 322.0, 236.0, -0.012, 0.004, -0.002, 0.0002}};
}

/// Unit-variance noise that depends on the seed alone: the sum of twelve uniform numbers from the specified engine
/// (std::normal_distribution differs between libraries).
class Noise {
  public:
    explicit Noise(unsigned seed) : engine_(seed) {}
    double operator()() {
        double sum = -6.0;
        for (int i = 0; i < 12; ++i) {
            sum += static_cast<double>(engine_()) / 4294967296.0;
        }
        return sum;
    }

  private:
    std::mt19937 engine_;
};

/// Exact projections of the chart's points.
inline ChartView view_of(const CameraModel& camera, const Pose& pose, const scene::Chart& chart) {
    ChartView view{.name = "synthetic", .chart_mm = {}, .image_px = {}};
    for (const Vec2d& point : scene::feature_points(chart)) {
        if (const auto pixel = project(camera, to_camera(pose, point))) {
            view.chart_mm.push_back(point);
            view.image_px.push_back(*pixel);
        }
    }
    return view;
}

/// Chart-to-camera poses that tilt the chart every way, at `distance_mm`.
inline std::vector<Pose> tilted_poses(double distance_mm, double tilt_rad, double shift_mm) {
    std::vector<Pose> poses;
    for (const double x : {-1.0, 1.0}) {
        for (const double y : {-1.0, 1.0}) {
            poses.push_back({{tilt_rad * y, tilt_rad * x, 0.1 * x}, {shift_mm * x, 0.7 * shift_mm * y, distance_mm}});
        }
    }
    poses.push_back({{0.02, -0.03, 0.0}, {0.0, 0.0, distance_mm}});
    return poses;
}

/// The chart's axes in the camera's frame.
inline std::array<Vec3d, 3> axes(const Pose& pose) {
    const Vec3d x = to_camera(pose, {1.0, 0.0}) - pose.translation_mm;
    const Vec3d y = to_camera(pose, {0.0, 1.0}) - pose.translation_mm;
    return {x, y, cross(x, y)};
}

/// Where a fit images a point that stays where it is on every chart: the mean of what the views say of it.
inline Vec2d imaged_again(const std::vector<Pose>& before, const GeometryFit& fit, const Vec3d& point, bool infinite) {
    Vec3d mean;
    for (std::size_t v = 0; v < before.size(); ++v) {
        const Vec3d arm = infinite ? point : point - before[v].translation_mm;
        const auto old_axes = axes(before[v]);
        const auto new_axes = axes(fit.views[v].pose);
        Vec3d moved = infinite ? Vec3d{} : fit.views[v].pose.translation_mm;
        for (std::size_t k = 0; k < 3; ++k) {
            moved = moved + dot(arm, old_axes[k]) * new_axes[k];
        }
        mean = mean + (1.0 / static_cast<double>(before.size())) * moved;
    }
    return project(fit.model, mean).value();
}

/// Heights of n² samples in a pixel, from its middle, px: a golden-ratio lattice, so that along both axes they lie in
/// different places and no edge falls between them; about their own mean, so that they pull no edge to one side.
inline std::vector<double> sample_heights(int n) {
    std::vector<double> heights;
    double mean = 0.0;
    for (int k = 0; k < n * n; ++k) {
        heights.push_back(std::fmod((k + 0.5) * 0.6180339887498949, 1.0));
        mean += heights.back() / (n * n);
    }
    for (double& height : heights) {
        height -= mean;
    }
    return heights;
}

/// A picture with n² point samples a pixel: `brightness(pixel)` times the chart's reflectance.
///
/// The map to the chart is exact every 2 px and bilinear between, which moves an edge by less than 1e-3 px.
inline void paint(
    formats::Image& image, int channel, const CameraModel& camera, const Pose& pose, const scene::Chart& chart, int n,
    const std::function<double(const Vec2d&)>& brightness = [](const Vec2d&) { return 1.0; }) {
    const std::vector<double> heights = sample_heights(n);
    const int columns = image.width / 2 + 2;
    const int rows = image.height / 2 + 2;
    std::vector<std::optional<Vec2d>> knots;
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            knots.push_back(chart_point(camera, pose, {2.0 * i - 0.5, 2.0 * j - 0.5}));
        }
    }
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const std::size_t first = static_cast<std::size_t>(y / 2) * columns + x / 2;
            const auto& a = knots[first];
            const auto& b = knots[first + 1];
            const auto& c = knots[first + columns];
            const auto& d = knots[first + columns + 1];
            double sum = 0.0;
            for (int k = 0; k < n * n && a && b && c && d; ++k) {
                const double u = (x % 2 + (k + 0.5) / (n * n)) / 2.0;
                const double v = (y % 2 + 0.5 + heights[k]) / 2.0;
                sum += scene::reflectance(chart, std::lerp(std::lerp(a->x, b->x, u), std::lerp(c->x, d->x, u), v),
                                          std::lerp(std::lerp(a->y, b->y, u), std::lerp(c->y, d->y, u), v));
            }
            image.at(x, y, channel) = static_cast<float>(sum / (n * n) * brightness({double(x), double(y)}));
        }
    }
}

inline void add_noise(formats::Image& image, double sigma, unsigned seed) {
    Noise noise(seed);
    for (float& value : image.pixels) {
        value += static_cast<float>(sigma * noise());
    }
}

}  // namespace lensproof::calibration::synthetic
