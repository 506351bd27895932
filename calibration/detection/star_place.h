// calibration/detection/star_place.h — where a star is imaged, or any light that is small, on a dark sky.
#pragma once
#include <optional>

#include "engine/base/vec.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

struct StarPlace {
    Vec2d centre_px;
    Vec2d standard_error_px;  // by the noise of the sky around it; not by the light's own
};

/// The brightest spot within `reach_px` of a place, if it stands out of the sky's noise: its centroid weighted with
/// a Gaussian that follows it and becomes as wide as the spot is (Bernstein & Jarvis 2002, The Astronomical Journal
/// 123, 583, §3.1; round ones). None where there is none, and for what is not finite around it.
std::optional<StarPlace> locate_star(const formats::Image& image, int channel, const Vec2d& near_px, double reach_px);

}  // namespace lensproof::calibration
