// engine/formats/image/jpeg.h — what JPEG does to a picture, and what its files must not say.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "engine/formats/image/image.h"

namespace lensproof::formats {

/// The picture, R, G, B or Y in linear light, as it comes back from a JPEG of `quality` (1 to 100): 8-bit sRGB, colours
/// at half the resolution, without the file. Throws std::runtime_error where the library fails.
Image after_jpeg(const Image& image, int quality);

/// The quality (1 to 100) that the file of these bytes was compressed with, as libjpeg counts it: the one whose scaled
/// standard tables (ITU T.81, annex K) are nearest to the luminance table in the file, by the sum of absolute
/// differences of their logarithms. Other encoders' tables have a nearest one as well. None for what is no JPEG, and
/// without that table.
std::optional<int> jpeg_quality(std::string_view file);

/// What keeps a JPEG of these bytes from its reader: it is cut off; it goes over the picture (SOS) more often than any
/// encoder does, once or, where it is progressive, about ten times, of which each takes a reader as long as the whole
/// picture, however few bytes it has; or metadata that the reader would look for beyond their segment. Empty: nothing.
std::string jpeg_fault(std::string_view file);

}  // namespace lensproof::formats
