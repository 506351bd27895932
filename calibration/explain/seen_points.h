// calibration/explain/seen_points.h — what profiles hold that a lens has to explain.
#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibration/geometry/reprojection.h"
#include "calibration/profile/profile.h"
#include "engine/base/vec.h"
#include "engine/optics/lens.h"

namespace lensproof::calibration {

/// A point of the chart, and the pixel that would show it were it a point: the profile's model of it, with what the
/// picture's own detection left. (A disc's centroid lies elsewhere than the image of its middle.)
struct SeenPoint {
    Vec3d board_mm;
    Vec2d image_px;
};

struct SeenView {
    std::string image;
    int profile = 0;
    PoseParameters pose{};  // as the profile has it: a start; camera's frame (calibration/geometry/camera_model.h)
    std::vector<SeenPoint> points;
};

/// The seven terms of a channel's shift against green (calibration/chromatic/chromatic_shift.h), at `objects` in the
/// camera's frame that are imaged evenly over the frame.
struct SeenShift {
    int profile = 0;
    int channel = 0;  // 0 red, 2 blue
    std::vector<Vec3d> objects{};
    Eigen::MatrixXd terms_of_shifts{};  // 7 × 2n: least squares of shifts (x, y, x, y, …; px) by the terms
    Eigen::VectorXd terms{};            // as measured
    Eigen::MatrixXd whitening{};        // that takes their covariance to 1
};

/// A camera's picture: lens space has y up, the picture's rows run down, and what is right is imaged left.
struct SeenCamera {
    int width_px = 0;
    int height_px = 0;
    double pitch_mm = 0.0;
    /// Standard deviation of a coordinate of a point: what the profile's own model leaves.
    std::vector<double> noise_px;
    std::vector<double> chart_mm;  // the charts' mean distance
};

struct SeenPoints {
    SeenCamera camera;
    std::vector<SeenView> views;
    std::vector<SeenShift> shifts;

    [[nodiscard]] int count() const;
};

/// At most so much is used of all profiles, evenly: more noise-free digits than the lens's own tolerances need.
inline constexpr std::size_t kMostViews = 40;
inline constexpr int kMostPoints = 1000;

/// A profile and its file's name, for messages.
struct NamedProfile {
    std::string file;
    Profile profile;
};

/// Throws InputError where a profile has no points, pixel pitch or geometry, or is another camera's than the first, and
/// for more than kMostViews of them.
SeenPoints seen_points(const std::vector<NamedProfile>& profiles);

}  // namespace lensproof::calibration
