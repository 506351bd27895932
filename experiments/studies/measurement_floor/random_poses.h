// experiments/studies/measurement_floor/random_poses.h — places of a chart in front of a camera, drawn, and what is
// seen there.
#pragma once
#include <random>
#include <vector>

#include "calibration/geometry/camera_model.h"
#include "calibration/geometry/fit_geometry.h"
#include "calibration/geometry/planar_pose.h"
#include "engine/base/vec.h"

namespace lensproof::studies {

// The simulated cameras' pictures, px.
inline constexpr int kWidth = 640;
inline constexpr int kHeight = 480;
inline constexpr double kHalfDiagonal = 400.0;

/// Numbers in [0, 1) from the generator's own bits; std::uniform_real_distribution differs between libraries.
inline double uniform(std::mt19937& random) {
    return static_cast<double>(random()) / 4294967296.0;
}
/// A standard normal number (Box & Muller 1958).
double normal(std::mt19937& random);

/// What a picture shows of a chart, and how it stands.
struct PoseWish {
    double tilt_deg = 20.0;          // of the chart's plane against the picture's, about an axis that is drawn
    double largest_roll_deg = 10.0;  // about its own normal, either way
    double fill = 0.75;  // width of the chart over that of the picture, when it faces the camera in the middle
    double reach = 0.1;  // how far from the middle its centre may be seen, of half the picture, either way
};

/// A chart `width_mm` wide, centred at its origin, in a picture of `width_px` × `height_px`.
calibration::Pose draw_pose(const calibration::CameraModel& model, int width_px, int height_px, double width_mm,
                            const PoseWish& wish, std::mt19937& random);

/// The picture that points are seen in, and their noise.
struct SeenThrough {
    calibration::CameraModel model;
    int width_px = 640;
    int height_px = 480;
    double noise_px = 0.02;  // standard deviation of one coordinate of one point
};

/// `count` views of a board of 9 × 6 points, 30 mm apart, each with the points that are at least 5 px inside the
/// picture; views with fewer than 12 points are drawn again.
std::vector<calibration::ChartView> draw_views(const SeenThrough& camera, int count, const PoseWish& wish,
                                               std::mt19937& random);

}  // namespace lensproof::studies
