#include "calibration/comparison/warp.h"

#include <algorithm>
#include <cmath>

#include "engine/base/angle.h"

namespace lensproof::calibration {

std::string warp_model_name(WarpModel model) {
    return kWarpModelNames[static_cast<std::size_t>(model)];
}

FrameScale::FrameScale(int width, int height)
    : middle_px{0.5 * (width - 1), 0.5 * (height - 1)}, half_diagonal_px(0.5 * std::hypot(width, height)) {}

Warp small_warp(const WarpTerms& terms) {
    const auto& [x, y, scale, turn, stretch, shear, p, q] = terms;
    return {.matrix = {Vec3d{1.0 + scale + stretch, shear - turn, x}, Vec3d{shear + turn, 1.0 + scale - stretch, y},
                       Vec3d{p, q, 1.0}}};
}

Warp composed(const Warp& outer, const Warp& inner) {
    Warp result{.matrix = product(outer.matrix, inner.matrix)};
    const double one = 1.0 / result.matrix[2].z;
    for (Vec3d& row : result.matrix) {
        row = one * row;
    }
    return result;
}

std::array<double, kMostWarpTerms> warp_parameters(const Warp& warp, const FrameScale& frame) {
    const auto& [top, middle, bottom] = warp.matrix;
    const double w = bottom.z;
    const Vec2d shift{top.z / w, middle.z / w};
    // The derivatives at the middle.
    const double xx = top.x / w - shift.x * bottom.x / w;
    const double xy = top.y / w - shift.x * bottom.y / w;
    const double yx = middle.x / w - shift.y * bottom.x / w;
    const double yy = middle.y / w - shift.y * bottom.y / w;
    const double scale = 0.5 * std::hypot(xx + yy, yx - xy);
    const double size = frame.half_diagonal_px;
    return {size * shift.x,
            size * shift.y,
            scale,
            degrees(std::atan2(yx - xy, xx + yy)),
            0.5 * (xx - yy) / scale,
            0.5 * (xy + yx) / scale,
            bottom.x / w / size,
            bottom.y / w / size};
}

double farthest_move_px(const Warp& warp, int width, int height) {
    const FrameScale frame(width, height);
    double farthest = 0.0;
    for (const double x : {0.0, width - 1.0}) {
        for (const double y : {0.0, height - 1.0}) {
            const Vec2d from = frame.unit(x, y);
            const Vec2d to = warp(from);
            farthest = std::max(farthest, frame.half_diagonal_px * std::hypot(to.x - from.x, to.y - from.y));
        }
    }
    return farthest;
}

}  // namespace lensproof::calibration
