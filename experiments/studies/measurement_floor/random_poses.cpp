#include "experiments/studies/measurement_floor/random_poses.h"

#include <ceres/rotation.h>
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "engine/base/angle.h"

namespace lensproof::studies {

double normal(std::mt19937& random) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(random)));
    return radius * std::cos(2.0 * std::numbers::pi * uniform(random));
}

calibration::Pose draw_pose(const calibration::CameraModel& model, int width_px, int height_px, double width_mm,
                            const PoseWish& wish, std::mt19937& random) {
    const double azimuth = 2.0 * std::numbers::pi * uniform(random);
    const double tilt[3] = {wish.tilt_deg * kDegree * std::cos(azimuth), wish.tilt_deg * kDegree * std::sin(azimuth),
                            0.0};
    const double roll[3] = {0.0, 0.0, (2.0 * uniform(random) - 1.0) * wish.largest_roll_deg * kDegree};
    double tilt_quaternion[4];
    double roll_quaternion[4];
    double both[4];
    double rotation[3];
    ceres::AngleAxisToQuaternion(tilt, tilt_quaternion);
    ceres::AngleAxisToQuaternion(roll, roll_quaternion);
    ceres::QuaternionProduct(tilt_quaternion, roll_quaternion, both);
    ceres::QuaternionToAngleAxis(both, rotation);

    const Vec2d middle{(width_px - 1) / 2.0, (height_px - 1) / 2.0};
    const Vec2d seen_at{middle.x + (2.0 * uniform(random) - 1.0) * wish.reach * width_px / 2.0,
                        middle.y + (2.0 * uniform(random) - 1.0) * wish.reach * height_px / 2.0};
    const Vec3d direction = calibration::unproject(model, seen_at).value_or(Vec3d{0.0, 0.0, 1.0});
    const double distance = calibration::focal_length_px(model) * width_mm / (wish.fill * width_px);
    return {{rotation[0], rotation[1], rotation[2]}, distance * direction};
}

std::vector<calibration::ChartView> draw_views(const SeenThrough& camera, int count, const PoseWish& wish,
                                               std::mt19937& random) {
    constexpr int kColumns = 9;
    constexpr int kRows = 6;
    constexpr double kPitch_mm = 30.0;
    constexpr double kMargin_px = 5.0;
    constexpr std::size_t kFewest = 12;
    std::vector<calibration::ChartView> views;
    while (static_cast<int>(views.size()) < count) {
        const calibration::Pose pose =
            draw_pose(camera.model, camera.width_px, camera.height_px, kPitch_mm * (kColumns + 1), wish, random);
        calibration::ChartView view{.name = fmt::format("view {}", views.size() + 1), .chart_mm = {}, .image_px = {}};
        for (int j = 0; j < kRows; ++j) {
            for (int i = 0; i < kColumns; ++i) {
                const Vec2d chart{kPitch_mm * (i - 0.5 * (kColumns - 1)), kPitch_mm * (j - 0.5 * (kRows - 1))};
                const auto pixel = calibration::project(camera.model, calibration::to_camera(pose, chart));
                if (pixel && pixel->x > kMargin_px && pixel->y > kMargin_px &&
                    pixel->x < camera.width_px - 1 - kMargin_px && pixel->y < camera.height_px - 1 - kMargin_px) {
                    view.chart_mm.push_back(chart);
                    view.image_px.push_back(
                        {pixel->x + camera.noise_px * normal(random), pixel->y + camera.noise_px * normal(random)});
                }
            }
        }
        if (view.chart_mm.size() >= kFewest) {
            views.push_back(std::move(view));
        }
    }
    return views;
}

}  // namespace lensproof::studies
