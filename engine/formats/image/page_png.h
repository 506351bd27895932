// engine/formats/image/page_png.h — a page of greys as a PNG that knows how large it is on paper.
#pragma once
#include <string>
#include <vector>

namespace lensproof::formats {

/// The bytes of a PNG with one channel of 8 bits, 0 black to 255 white, row by row from the top. `dpi` goes into its
/// resolution (pHYs, in whole pixels per metre), by which programs print it at its size. Throws std::runtime_error
/// where the library fails.
std::string encode_page_png(int width, int height, const std::vector<unsigned char>& grey, double dpi);

}  // namespace lensproof::formats
