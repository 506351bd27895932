// calibration/geometry/bundle.h — one least-squares step of a bundle adjustment: a camera, a board and its poses.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/camera_model.h"
#include "calibration/geometry/reprojection.h"

namespace lensproof::calibration {

/// The points of one picture: where they are on the chart and in the picture.
struct ChartView {
    std::string name;  // for messages
    std::vector<Vec2d> chart_mm;
    std::vector<Vec2d> image_px;
    double weight = 1.0;  // of its squared residuals
    /// In place of `chart_mm`: unit vectors to what is infinitely far away (stars), in a frame of their own. The view's
    /// pose turns them, and has no translation.
    std::vector<Vec3d> directions = {};

    [[nodiscard]] bool is_far() const { return !directions.empty(); }
    [[nodiscard]] int pose_unknowns() const { return is_far() ? 3 : 6; }
};

/// Where the pose puts a point, in the camera's frame: mm, or a direction.
Vec3d in_camera(const ChartView& view, std::size_t point, const Pose& pose);

/// Adds a point of another view of the same kind.
void add_point(ChartView& to, const ChartView& from, std::size_t point);

/// What was measured.
struct PointBundle {
    std::vector<ChartView> views;
    std::vector<std::vector<bool>> used;  // of each view's points
    double disc_diameter_mm = 0.0;
    BoardFrame frame;
};

/// The bundle of all points; the frame encloses them.
PointBundle make_bundle(const std::vector<ChartView>& views, double disc_diameter_mm);

Feature feature(const PointBundle& bundle, std::size_t view, std::size_t point);

int count_used(const PointBundle& bundle);

/// What explains it.
struct BundleState {
    CameraModel model;
    std::vector<PoseParameters> poses;
    BoardHeights heights{};
};

/// What a step leaves alone.
struct Held {
    std::vector<int> intrinsics;  // indices into `parameters(model)`, ascending
    bool poses = false;
    bool heights = true;
};

/// Brings `state` to the least sum of weighted squared residuals of the points used (Levenberg and Marquardt, by
/// Ceres), and returns half that sum; infinity when nothing usable was found. With `cauchy_scale_px` > 0 the squares
/// beyond about that length are weighted down by Cauchy's loss.
double solve(const PointBundle& bundle, BundleState& state, const Held& held, double cauchy_scale_px = 0.0);

/// Measured minus predicted; none where the model images nothing.
std::optional<Vec2d> residual(const PointBundle& bundle, const BundleState& state, std::size_t view, std::size_t point);

/// What the points tell about each parameter, to first order about `state` and per unit variance of a coordinate.
/// "Shared" are the intrinsics followed by the board's heights.
struct BundleInformation {
    int shared = 0;
    std::vector<double> shared_covariance;  // rows of held parameters are 0
    /// The scatter of the shared parameters when views are left out one by one (the jackknife, to first order: Miller
    /// 1974, Biometrika 61, 1; its clusters are the views), px² and all. Knows nothing of a noise model; (views − 1)
    /// degrees of freedom. Empty for fewer than five views.
    std::vector<double> view_covariance;
    struct View {
        std::array<double, 36> pose_covariance{};  // were the shared parameters known
        std::vector<double> pose_follows;          // 6 × shared: how the pose moves with the shared parameters
    };
    std::vector<View> views;
};

/// What the points do not determine has a huge variance. None for numbers that are not finite.
std::optional<BundleInformation> information(const PointBundle& bundle, const BundleState& state, const Held& held);

}  // namespace lensproof::calibration
