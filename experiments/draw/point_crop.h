// experiments/draw/point_crop.h — what lies about a point of a picture, pixel by pixel, with where it was found and
// where it was expected.
#pragma once
#include <string>
#include <vector>

#include "engine/base/vec.h"
#include "engine/formats/image/image.h"

namespace lensproof::draw {

inline constexpr int kCropSide = 33;  // px

/// The pixels about `at_px`, of which some may lie beyond the picture: black. As grey between the darkest and the
/// brightest of `channel`.
struct PointCrop {
    PointCrop() = default;
    PointCrop(std::string label_, const formats::Image& picture, int channel, const Vec2d& at_px);

    std::string label{};
    formats::Image grey{};
    Vec2d corner_px{};  // of the crop's first pixel, in the picture
};

/// A place in a crop.
struct CropMark {
    Vec2d at_px;  // in the picture
    std::string label;
    bool is_expected = false;  // drawn as a ring, else as a cross
};

/// The crops side by side, the marks in each, and below them what they stand for.
std::string point_crops_svg(const std::vector<PointCrop>& crops, const std::vector<CropMark>& marks);

}  // namespace lensproof::draw
