// engine/formats/image/frame_placement.h — pictures that are more or less than the frame that they belong to.
#pragma once
#include <filesystem>

#include "engine/formats/image/image.h"

namespace lensproof::formats {

/// Where the first pixel of a picture lies in its frame, and how large the frame is, px.
struct FramePlacement {
    int x = 0;
    int y = 0;
    int frame_width = 0;
    int frame_height = 0;
};

/// As write_exr does without: the picture is EXR's data window, the frame its display window.
void write_exr(const Image& image, const std::filesystem::path& file, const FramePlacement& placement);

}  // namespace lensproof::formats
