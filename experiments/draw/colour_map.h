// experiments/draw/colour_map.h — colours that stand for numbers.
#pragma once
#include <string>

#include "engine/base/vec.h"

namespace lensproof::draw {

enum class ColourMap {
    sequential,  // from dark violet over blue and green to light yellow
    diverging,   // from blue over nearly white, in the middle, to red
};

/// The colour at `fraction` (0 to 1) of a map, linear sRGB from 0 to 1.
///
/// Maps are computed in OKLab (Ottosson, "A perceptual color space for image processing", 2020), so that equal steps of
/// the number look equal: lightness runs straight, the hue turns evenly (or is one on either side of the middle), and
/// the chroma is as strong as sRGB allows up to a limit.
Vec3d map_colour(ColourMap map, double fraction);

/// The same as "#rrggbb".
std::string map_colour_text(ColourMap map, double fraction);

}  // namespace lensproof::draw
