// experiments/studies/tradeoff/chief_images.h — where a lens's chief rays put points of light.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "engine/base/vec.h"
#include "experiments/studies/tradeoff/field_probe.h"

namespace lensproof::studies {

/// Of the chief rays of a point, a wavelength each, in R, G and B: the centroid of where they land, px from the point's
/// pixel, and their mean square distance from it, px².
struct ChiefImage {
    std::array<Vec2d, 3> at{};
    std::array<double, 3> squared_spread{};
};

/// In the order of the points: by real chief rays, beyond rims too. Nothing beyond the field that the lens images;
/// nothing at all of a lens that is not rotationally symmetric. `exact`: the camera that the points are of.
std::vector<std::optional<ChiefImage>> chief_images(const render::Camera& exact, const std::vector<ProbePoint>& points,
                                                    int threads);

}  // namespace lensproof::studies
