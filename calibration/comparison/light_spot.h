// calibration/comparison/light_spot.h — a patch of light in a picture, as a lamp out of focus or a ghost: where it
// lies, how large it is, its shape and its colour.
#pragma once
#include <vector>

#include "calibration/comparison/overlap.h"
#include "calibration/sharpness/slanted_edge.h"
#include "engine/base/vec.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// Its moments, of the light above the plane through what is about it. An even disc has its own diameter and elongation
/// 1; what is brighter in its middle is smaller, a ring larger.
struct LightSpot {
    Estimate x_px;  // of its centroid
    Estimate y_px;
    Estimate diameter_px;           // of the even ellipse as wide: the geometric mean of its axes
    Estimate elongation;            // the longer axis over the shorter
    Estimate angle_deg;             // of the longer, from +x towards +y, in (-90, 90]
    std::vector<Estimate> light;    // of each channel, the sum over its pixels
    double clipped_fraction = 0.0;  // of its pixels, those at `clipped_from` and above

    /// log2 of one channel's light over another's.
    [[nodiscard]] Estimate colour_ev(int channel, int over) const;
};

/// The one in the box, whose outer tenth on each side shows what is about it. Errors are those of the pixels' noise,
/// taken to be independent and of one size in the light and of another beside it: medians of how far pixels are from
/// the mean of their neighbours. Throws InputError for a box beyond the picture or below 10 px a side, and where no
/// light stands five standard errors above what is about it.
LightSpot measure_spot(const formats::Image& image, const PixelRectangle& box, double clipped_from);

}  // namespace lensproof::calibration
