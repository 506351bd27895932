// engine/formats/image/exr_header.h — whether an OpenEXR file can hold what its headers promise.
#pragma once
#include <filesystem>

namespace lensproof::formats {

/// Whether each attribute ends within the file, and the file has room for the 8 bytes that stand in it for each chunk
/// of each part (OpenEXR File Layout, "Offset Tables"). The library makes room for both before it looks.
bool exr_header_fits(const std::filesystem::path& file);

}  // namespace lensproof::formats
