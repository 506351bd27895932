// engine/io/jpeg.h — what JPEG does to a picture.
#pragma once
#include "engine/io/image.h"

namespace lensproof {

/// The picture, R, G, B or Y in linear light, as it comes back from a JPEG of `quality` (1 to 100): 8-bit sRGB, colours
/// at half the resolution, without the file. Throws std::runtime_error where the library fails.
Image after_jpeg(const Image& image, int quality);

}  // namespace lensproof
