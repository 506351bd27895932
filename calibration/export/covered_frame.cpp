#include "calibration/export/covered_frame.h"

#include <algorithm>
#include <cmath>

#include "engine/base/input_error.h"

namespace lensproof::calibration {
namespace {

double covered_radius_px(const Profile& profile) {
    // The farthest point lies at this radius exactly; rounding must not leave it out.
    return exported_geometry(profile).covered_image_height * half_diagonal_px(profile) * (1.0 + 1e-12);
}

}  // namespace

const ProfileGeometry& exported_geometry(const Profile& profile) {
    if (!profile.geometry || !(profile.geometry->covered_image_height > 0.0)) {
        const std::string reason = why_not_measured(profile, part::kGeometry, "");
        throw InputError("the profile has no camera model" + (reason.empty() ? "" : " (" + reason + ")") +
                         ": expected one measured from pictures of a chart");
    }
    return *profile.geometry;
}

std::vector<FramePoint> frame_points(const Profile& profile, int columns) {
    const CameraModel& model = exported_geometry(profile).model;
    const double covered = covered_radius_px(profile);
    const Vec2d centre = centre_px(model);
    const int rows = std::max(2, columns * profile.height_px / profile.width_px);
    std::vector<FramePoint> points;
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const Vec2d pixel{(profile.width_px - 1.0) * i / (columns - 1.0),
                              (profile.height_px - 1.0) * j / (rows - 1.0)};
            if (const auto direction = unproject(model, pixel)) {
                const bool inside = std::hypot(pixel.x - centre.x, pixel.y - centre.y) <= covered;
                points.push_back({pixel, *direction, inside});
            }
        }
    }
    return points;
}

std::optional<double> largest_difference_px(const std::vector<FramePoint>& points,
                                            const std::function<std::optional<Vec2d>(const Vec3d&)>& model) {
    double largest = 0.0;
    for (const FramePoint& point : points) {
        if (!point.covered) {
            continue;
        }
        const auto pixel = model(point.direction);
        if (!pixel || !std::isfinite(pixel->x) || !std::isfinite(pixel->y)) {
            return std::nullopt;
        }
        largest = std::max(largest, std::hypot(pixel->x - point.pixel_px.x, pixel->y - point.pixel_px.y));
    }
    return largest;
}

std::vector<RadialPoint> radial_points(const Profile& profile, int count) {
    const CameraModel& model = exported_geometry(profile).model;
    const double covered = covered_radius_px(profile);
    const Vec2d centre = centre_px(model);
    const double corner = std::hypot(std::max(centre.x, profile.width_px - 1.0 - centre.x),
                                     std::max(centre.y, profile.height_px - 1.0 - centre.y));
    std::vector<RadialPoint> points;
    for (int i = 1; i <= count; ++i) {
        const double radius = corner * i / count;
        if (const auto angle = field_angle_rad(model, radius)) {
            points.push_back({*angle, radius, radius <= covered});
        }
    }
    return points;
}

}  // namespace lensproof::calibration
