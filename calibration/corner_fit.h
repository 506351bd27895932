// calibration/corner_fit.h — where two edges cross, from a model of the light around the crossing.
#pragma once
#include <opencv2/core.hpp>
#include <optional>

#include "engine/optics/vec.h"

namespace lensproof {

/// What a corner fit starts from: the corner to about a pixel, and the directions of the two edges that cross there
/// (px, any length).
struct CornerStart {
    Vec2d corner_px;
    Vec2d along_first;
    Vec2d along_second;
};

/// The corner of a checkerboard, by least squares (Ceres) of
///     I(x, y) = a + g·(x, y) + b erf(d₁ / √2σ) erf(d₂ / √2σ)
/// over the (2 h + 1)² pixels around the start, where d₁, d₂ are the distances from the two edges: straight lines, or
/// parabolas where the window is wide enough to tell (h ≥ 6; a fisheye bends edges by 0.05 px and more within one). σ
/// is the edges' blur, the pixel's own box in it; g takes up uneven light.
///
/// `plane` is CV_32F in linear light. None where the fit does not settle on an edge-like corner within 1.5 px of the
/// start.
std::optional<Vec2d> fit_corner(const cv::Mat& plane, const CornerStart& start, int half_window);

}  // namespace lensproof
