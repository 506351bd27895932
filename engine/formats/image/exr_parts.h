// engine/formats/image/exr_parts.h — several pictures in one EXR file.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/formats/image/image.h"

namespace lensproof::formats {

struct NamedImage {
    std::string name;
    Image image;
};

/// As `write_exr` for one picture; a part each, by their names.
void write_exr(const std::vector<NamedImage>& parts, const std::filesystem::path& file);

}  // namespace lensproof::formats
