// engine/formats/image/stated_sizes.h — whether a picture's file can hold what it states: libraries make room before
// they look.
#pragma once
#include <filesystem>

namespace lensproof::formats {

/// Whether each attribute ends within the file and is as long as its type says, and the file has room for the 8 bytes
/// that stand in it for each chunk of each part (OpenEXR File Layout, "Offset Tables").
bool exr_header_fits(const std::filesystem::path& file);

/// Whether each chunk of a PNG, up to the last (IEND), ends within the file.
bool png_chunks_fit(const std::filesystem::path& file);

}  // namespace lensproof::formats
