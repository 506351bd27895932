// calibration/picture/flat_field_traits.h — what a picture of an even surface is like.
#pragma once
#include "engine/formats/image/image.h"

namespace lensproof::calibration {

/// Of one channel in linear light, full scale 1.
struct FlatFieldTraits {
    double white = 0.0;  // the mean of the middle twentieth of the picture's width and height
    double noise = 0.0;  // standard deviation of a pixel, as in picture_traits.h, over the whole picture
};

/// Of a picture of 8 pixels and more a side; of a smaller one, all 0.
FlatFieldTraits flat_field_traits(const formats::Image& image, int channel);

}  // namespace lensproof::calibration
