// experiments/draw/line_plots.h — edges that are straight in the world, on the picture that shows them bent.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/vec.h"

namespace lensproof::draw {

/// Pixels as in engine/formats/image/image.h.
struct MarkedLine {
    std::vector<Vec2d> points_px;
    std::vector<double> residual_px;  // of each, from the straight line's image, to the left of the way along it
    bool used = false;
};

/// A picture (the bytes of a PNG, of any size) of a frame that large with its lines: blue what was used, vermilion and
/// dashed what was left out, and beside each, thin, where its points would lie were their residuals larger by a factor
/// that stands under the title.
std::string marked_lines_svg(const std::string& title, int width_px, int height_px, std::string_view png,
                             const std::vector<MarkedLine>& lines);

}  // namespace lensproof::draw
