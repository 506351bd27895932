// calibration/detection/spot_centroid.h — the centroid of a disc, dot or square on even ground.
#pragma once
#include <optional>

#include "engine/base/vec.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// Where a spot's light is gathered. Lengths count in units of their own: a pixel at an offset d from the centre is
/// |u| away, where d = u_x x_unit_px + u_y y_unit_px; so a circle there is the ellipse that perspective makes of it.
struct SpotWindow {
    Vec2d x_unit_px{1.0, 0.0};
    Vec2d y_unit_px{0.0, 1.0};
    double inner = 0.0;           // the spot and its blur end here; a pixel at this rim counts by its fraction inside
    double outer = 0.0;           // light from inner to outer is the ground's
    double area_px = 0.0;         // of the spot
    double least_fraction = 0.1;  // of the darkness (or brightness) that black (or the ground's double) would have
    bool is_bright = false;
};

struct Spot {
    Vec2d centre_px;
    Vec2d standard_error_px;  // of noise of standard deviation 1, independent from pixel to pixel
};

/// The centroid of 1 − I/W, W a plane through the ground's light; of a bright spot that of I − W. The window follows
/// the spot in a few rounds, as far as its outer half. None where the window leaves the picture, holds what is no
/// number, or shows no such spot.
std::optional<Spot> locate_spot(const formats::Image& image, int channel, const Vec2d& start, const SpotWindow& window);

}  // namespace lensproof::calibration
