// engine/formats/image/raw_fault.h — raw files that LibRaw 0.20 cannot read without harm.
#pragma once
#include <filesystem>
#include <string>

namespace lensproof::formats {

/// What is wrong with a raw file, else nothing: where a maker's name has "Hasselblad" in it, LibRaw appends to the
/// camera's name, and ends the program where that leaves no room. Looked at are the header's chain of directories,
/// those below them and Exif's, not what makers' notes hold; texts of up to 63 letters, whatever length is stated. In a
/// container that is no TIFF, of which Hasselblad makes none, its name is a fault.
std::string raw_fault(const std::filesystem::path& file);

}  // namespace lensproof::formats
