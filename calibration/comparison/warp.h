// calibration/comparison/warp.h — how one picture's places map to another's.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "engine/base/affine.h"
#include "engine/base/vec.h"

namespace lensproof::calibration {

/// Each is the one before it and two terms more.
enum class WarpModel { none, translation, similarity, affine, homography };

inline constexpr std::array kWarpModelNames = {"none", "translation", "similarity", "affine", "homography"};
std::string warp_model_name(WarpModel model);

inline constexpr int kMostWarpTerms = 8;
/// How many terms a model has: 0, 2, 4, 6 or 8.
constexpr int term_count(WarpModel model) {
    return 2 * static_cast<int>(model);
}

/// A small warp's terms: shift to the right and down, enlargement, turn, stretch along x and shrinking along y, shear,
/// and vanishing lines; in half-diagonals about the middle.
using WarpTerms = std::array<double, kMostWarpTerms>;

/// What each term moves a place by, to first order.
constexpr std::array<Vec2d, kMostWarpTerms> displacements(const Vec2d& u) {
    return {Vec2d{1.0, 0.0},
            Vec2d{0.0, 1.0},
            Vec2d{u.x, u.y},
            Vec2d{-u.y, u.x},
            Vec2d{u.x, -u.y},
            Vec2d{u.y, u.x},
            Vec2d{-u.x * u.x, -u.x * u.y},
            Vec2d{-u.x * u.y, -u.y * u.y}};
}

/// A frame's places in half-diagonals from its middle, x to the right and y down: the same for pictures of every
/// resolution.
struct FrameScale {
    Vec2d middle_px;
    double half_diagonal_px = 1.0;

    FrameScale(int width, int height);
    [[nodiscard]] Vec2d unit(double x, double y) const {
        return {(x - middle_px.x) / half_diagonal_px, (y - middle_px.y) / half_diagonal_px};
    }
    [[nodiscard]] Vec2d px(const Vec2d& u) const {
        return {middle_px.x + half_diagonal_px * u.x, middle_px.y + half_diagonal_px * u.y};
    }
};

/// A homography of such places.
struct Warp {
    Matrix3 matrix = kIdentity3;

    [[nodiscard]] Vec2d operator()(const Vec2d& u) const {
        const Vec3d p = matrix * Vec3d{u.x, u.y, 1.0};
        return {p.x / p.z, p.y / p.z};
    }
};

/// The warp of those terms.
Warp small_warp(const WarpTerms& terms);

/// First `inner`, then `outer`.
Warp composed(const Warp& outer, const Warp& inner);

/// What a person reads of a warp: all about the frame's middle, in this order `shift_x_px`, `shift_y_px`, `scale`,
/// `rotation_deg` (from x towards y), `stretch` and `shear` (ratios), `perspective_x_per_px` and `perspective_y_per_px`
/// (the denominator 1 + p·x of the homography).
inline constexpr std::array kWarpParameterNames = {
    "shift_x_px",           "shift_y_px",          "scale", "rotation_deg", "stretch", "shear",
    "perspective_x_per_px", "perspective_y_per_px"};
std::array<double, kMostWarpTerms> warp_parameters(const Warp& warp, const FrameScale& frame);

/// How far a warp moves the frame's corner that it moves farthest, px.
double farthest_move_px(const Warp& warp, int width, int height);

}  // namespace lensproof::calibration
