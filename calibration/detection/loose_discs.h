// calibration/detection/loose_discs.h — dark discs in a picture, found without knowing the chart they belong to.
#pragma once
#include <optional>
#include <vector>

#include "engine/base/vec.h"
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

struct LooseDisc {
    Vec2d centre_px;  // centroid of the missing light
    double radius_px = 0.0;
};

/// Dark round blobs on white that lie wholly in the picture with white around them: OpenCV's adaptive threshold and
/// connected components, those of about the most common size, then `locate_disc`. From the top, then the left.
std::vector<LooseDisc> find_loose_discs(const formats::Image& image, int channel);

/// The same disc in another picture of the same scene: its centroid (calibration/detection/spot_centroid.h) within 1.25
/// radii and a pixel of where it is expected. None where there is no such disc within half a radius.
std::optional<Vec2d> locate_disc(const formats::Image& image, int channel, const LooseDisc& expected);

}  // namespace lensproof::calibration
