#include "calibration/geometry/bundle_start.h"

#include <ceres/rotation.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "calibration/geometry/rotation_fit.h"
#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

std::optional<Pose> turning_pose(const std::vector<Vec3d>& directions, const std::vector<Vec3d>& rays) {
    const Eigen::Matrix3d rotation = rotation_onto(directions, rays);
    double vector[3];
    ceres::RotationMatrixToAngleAxis(rotation.data(), vector);
    return std::isfinite(vector[0] + vector[1] + vector[2])
               ? std::optional(Pose{.rotation_rad = {vector[0], vector[1], vector[2]}, .translation_mm = {}})
               : std::nullopt;
}

// Poses under an undistorted model of the given focal length, and the rms misfit of the rays in px.
std::optional<double> start_at(const PointBundle& bundle, ModelKind model, double focal, const Vec2d& middle,
                               BundleState& state) {
    std::vector<double> values = parameters(empty_model(model));
    values[0] = focal;
    values[1] = middle.x;
    values[2] = middle.y;
    state.model = with_parameters(empty_model(model), values);
    double sum = 0.0;
    std::size_t count = 0;
    for (const ChartView& view : bundle.views) {
        std::vector<Vec3d> rays;
        for (const Vec2d& pixel : view.image_px) {
            const double dx = pixel.x - middle.x;
            const double dy = pixel.y - middle.y;
            const double radius = std::hypot(dx, dy);
            const double angle = undistorted_angle_rad(model, focal, radius);
            if (angle > std::numbers::pi) {
                return std::nullopt;
            }
            const double lateral = radius > 0.0 ? std::sin(angle) / radius : 0.0;
            rays.push_back({lateral * dx, lateral * dy, std::cos(angle)});
        }
        const auto pose = view.is_far() ? turning_pose(view.directions, rays) : planar_pose(view.chart_mm, rays);
        if (!pose) {
            return std::nullopt;
        }
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Vec3d seen = normalized(in_camera(view, i, *pose));
            const double miss = focal * length(seen - rays[i]);
            sum += miss * miss;
        }
        count += rays.size();
        state.poses.push_back(pose_parameters(*pose));
    }
    const double rms = std::sqrt(sum / static_cast<double>(count));
    return std::isfinite(rms) ? std::optional(rms) : std::nullopt;
}

}  // namespace

std::vector<BundleStart> bundle_starts(const PointBundle& bundle, ModelKind model, int width, int height,
                                       std::optional<double> known_focal_px) {
    std::vector<double> focals;
    const double half_diagonal = 0.5 * std::hypot(width, height);
    if (known_focal_px) {
        focals = {*known_focal_px};
    } else {
        for (double focal = 0.25 * half_diagonal; focal < 40.0 * half_diagonal; focal *= 1.2) {
            focals.push_back(focal);
        }
    }
    std::vector<BundleStart> starts;
    for (const double focal : focals) {
        BundleStart start;
        if (const auto misfit = start_at(bundle, model, focal, {(width - 1) / 2.0, (height - 1) / 2.0}, start.state)) {
            start.misfit_px = *misfit;
            starts.push_back(std::move(start));
        }
    }
    if (starts.empty()) {
        throw InputError(
            "fitting a camera model: no view shows the chart's points as a flat chart would look; "
            "expected at least four points, not on a line, in every view");
    }
    std::stable_sort(starts.begin(), starts.end(),
                     [](const BundleStart& a, const BundleStart& b) { return a.misfit_px < b.misfit_px; });
    return starts;
}

}  // namespace lensproof::calibration
