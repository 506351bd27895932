// calibration/geometry/board_shape.h — how far a chart is from flat.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "engine/base/vec.h"

namespace lensproof::calibration {

/// The rectangle of the chart that its features span: the unit of the deformation.
struct BoardFrame {
    Vec2d centre_mm;
    Vec2d half_size_mm{1.0, 1.0};
};

inline constexpr int kBoardTerms = 5;
inline constexpr std::array<std::string_view, kBoardTerms> kBoardTermNames = {"bend_x_mm", "twist_mm", "bend_y_mm",
                                                                              "bend4_x_mm", "bend4_y_mm"};

/// Height of the chart's surface over its mean plane, along the chart's z axis, mm:
///     z = h₁ P₂(x) + h₂ x y + h₃ P₂(y) + h₄ P₄(x) + h₅ P₄(y),   x, y ∈ [−1, 1] over the frame,
/// P the Legendre polynomials. Height, tilt and with them every lower term belong to the pose. Two orders of bending
/// and the twist are what a board does that hangs, leans or dries unevenly.
template <class T>
T board_height(const BoardFrame& frame, const T* h, double x_mm, double y_mm) {
    const double x = (x_mm - frame.centre_mm.x) / frame.half_size_mm.x;
    const double y = (y_mm - frame.centre_mm.y) / frame.half_size_mm.y;
    const auto p2 = [](double t) { return 0.5 * (3.0 * t * t - 1.0); };
    const auto p4 = [](double t) { return 0.125 * ((35.0 * t * t - 30.0) * t * t + 3.0); };
    return h[0] * p2(x) + h[1] * (x * y) + h[2] * p2(y) + h[3] * p4(x) + h[4] * p4(y);
}

/// A fitted deformation. All 0: a flat chart, and no covariance.
struct BoardShape {
    BoardFrame frame;
    std::array<double, kBoardTerms> height_mm{};
    std::array<double, std::size_t{kBoardTerms} * kBoardTerms> covariance{};  // row by row
};

/// Of one term.
inline double standard_error_mm(const BoardShape& board, std::size_t term) {
    return std::sqrt(std::max(board.covariance[term * (kBoardTerms + 1)], 0.0));
}

}  // namespace lensproof::calibration
