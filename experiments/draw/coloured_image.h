// experiments/draw/coloured_image.h — numbers over a frame as a picture, a colour a pixel.
#pragma once
#include "engine/formats/image/image.h"
#include "experiments/draw/colour_map.h"

namespace lensproof::draw {

/// Of the first channel: `lowest` and `highest` at the ends of the colours, what is beyond them like the ends, what is
/// NaN in grey.
formats::Image coloured_image(const formats::Image& values, ColourMap colours, double lowest, double highest);

}  // namespace lensproof::draw
