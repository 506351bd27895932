#include "calibration/self_test/chart_point.h"

#include <algorithm>

namespace lensproof::calibration {
namespace {

constexpr int kBoardRounds = 6;  // each gains what slope and obliquity leave of the height: 0.1 and less

// A polynomial says nothing beyond the points that it was fitted to: there the surface goes straight on.
double height_mm(const BoardShape& board, const Vec2d& chart_mm) {
    const auto held = [](double value, double middle, double half) {
        return std::clamp(value, middle - half, middle + half);
    };
    const auto at = [&](double x, double y) { return board_height(board.frame, board.height_mm.data(), x, y); };
    const BoardFrame& frame = board.frame;
    const double x = held(chart_mm.x, frame.centre_mm.x, frame.half_size_mm.x);
    const double y = held(chart_mm.y, frame.centre_mm.y, frame.half_size_mm.y);
    double height = at(x, y);
    constexpr double kStep = 1e-4;  // of half the frame: the slope to a relative 1e-4
    if (x != chart_mm.x) {
        const double step = kStep * frame.half_size_mm.x;
        height += (at(x + step, y) - at(x - step, y)) / (2.0 * step) * (chart_mm.x - x);
    }
    if (y != chart_mm.y) {
        const double step = kStep * frame.half_size_mm.y;
        height += (at(x, y + step) - at(x, y - step)) / (2.0 * step) * (chart_mm.y - y);
    }
    return height;
}

}  // namespace

std::optional<Vec2d> chart_point(const Vec3d& direction, const Pose& pose, const std::optional<BoardShape>& board) {
    const Vec3d origin = pose.translation_mm;
    const Vec3d x_axis = to_camera(pose, {1.0, 0.0}) - origin;
    const Vec3d y_axis = to_camera(pose, {0.0, 1.0}) - origin;
    const Vec3d normal = cross(x_axis, y_axis);
    const double towards = dot(direction, normal);
    const auto meets = [&](double height_mm) -> std::optional<Vec2d> {
        const double distance = towards != 0.0 ? (dot(origin, normal) + height_mm) / towards : -1.0;
        if (!(distance > 0.0)) {
            return std::nullopt;
        }
        const Vec3d offset = distance * direction - origin;
        return Vec2d{dot(offset, x_axis), dot(offset, y_axis)};
    };
    std::optional<Vec2d> place = meets(0.0);
    for (int i = 0; board && place && i < kBoardRounds; ++i) {
        place = meets(height_mm(*board, *place));
    }
    return place;
}

std::optional<Vec2d> chart_point(const CameraModel& model, const Pose& pose, const Vec2d& pixel,
                                 const std::optional<BoardShape>& board) {
    const auto direction = unproject(model, pixel);
    return direction ? chart_point(*direction, pose, board) : std::nullopt;
}

}  // namespace lensproof::calibration
