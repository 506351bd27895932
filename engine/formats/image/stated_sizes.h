// engine/formats/image/stated_sizes.h — whether a picture's file can hold what it states: libraries make room before
// they look.
#pragma once
#include <filesystem>
#include <string>

namespace lensproof::formats {

/// What is wrong with an OpenEXR file's headers, else nothing: each attribute ends within the file and is as long as
/// its type says, channels are of a type that there is (OpenImageIO 2.4 ends the program at another), a chunk of
/// pixels, for which OpenEXR makes room when a file is opened, takes at most half a GiB, and the file has room for the
/// 8 bytes that stand in it for each chunk of each part (OpenEXR File Layout, "Offset Tables").
std::string exr_fault(const std::filesystem::path& file);

/// The same of a PNG: each of its chunks, up to the last (IEND), ends within the file.
std::string png_fault(const std::filesystem::path& file);

}  // namespace lensproof::formats
