// experiments/cli/pixel_rectangles.h — rectangles of pixels as options state them.
#pragma once
#include <string>
#include <vector>

#include "calibration/sharpness/slanted_edge.h"

namespace lensproof::cli {

/// "x,y,width,height". Throws InputError naming the option and what it `expected`.
calibration::PixelRectangle parse_rectangle(const std::string& option, const std::string& text,
                                            const std::string& expected = "x,y,width,height in pixels");

/// What --edge states: rectangles, of no size for "whole"; none for "auto", which stands alone.
std::vector<calibration::PixelRectangle> parse_edges(const std::vector<std::string>& edges);

}  // namespace lensproof::cli
