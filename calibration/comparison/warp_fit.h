// calibration/comparison/warp_fit.h — Gauss–Newton steps that bring one picture over another, and what they know.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "calibration/comparison/spline_surface.h"
#include "calibration/comparison/warp.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// A tile of the frame: the sums of products of what each pixel adds to the least-squares problem
///
///     b(W(x)) ≈ contrast · a(x) + offset − contrast Σ δ_k ∇a(x)·d_k(x)
///
/// for small terms δ of a warp that is done before W (the compositional step of Baker and Matthews 2004, by the
/// gradient of `a`, whose noise does not know that of `b`: so noise shifts nothing). Columns: ∇a·d_k, a, 1, b(W).
struct WarpTile {
    Eigen::Matrix<double, kMostWarpTerms + 3, kMostWarpTerms + 3> products;
    Vec2d middle;  // of its pixels, in half-diagonals
    double pixels = 0.0;
};

/// Two grey pictures of a size, of which the second is a surface.
struct WarpPair {
    const formats::Image& a;
    const SplineSurface& b;
    int margin_px = 4;  // along the frame's edges, which are left out of both
};

std::vector<WarpTile> warp_tiles(const WarpPair& pair, const Warp& warp, int threads);

/// The step that the tiles ask for.
struct WarpStep {
    bool is_determined = false;
    WarpTerms terms{};
    double contrast = 1.0;
    double overlap = 0.0;        // fraction of the frame
    Eigen::MatrixXd covariance;  // of the model's terms
};

/// The covariance is that of tiles whose residuals do not know each other ("sandwich": White 1980), whatever noise does
/// within them; of the pixels' residuals, as if independent, where there are not three tiles for a term.
WarpStep warp_step(const std::vector<WarpTile>& tiles, WarpModel model);

/// What a tile by itself says about how far it still is to be shifted.
struct TileShift {
    Vec2d middle;  // in half-diagonals
    Vec2d shift_px;
    Eigen::Matrix2d information;  // 1/px²; singular where edges run one way
};

std::vector<TileShift> tile_shifts(const std::vector<WarpTile>& tiles, double contrast, const FrameScale& frame);

/// Root mean square of the shifts, a component, each weighted by what is known of it, px.
double rms_shift_px(const std::vector<TileShift>& shifts);

}  // namespace lensproof::calibration
