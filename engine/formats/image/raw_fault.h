// engine/formats/image/raw_fault.h — raw files that LibRaw 0.20 cannot read without harm.
#pragma once
#include <filesystem>
#include <string>

namespace lensproof::formats {

/// What is wrong with a raw file that is built on TIFF, else nothing: where a maker's name has "Hasselblad" in it,
/// LibRaw appends to the camera's name, and ends the program where that leaves no room; real ones have 30 letters at
/// most. Looked at are all directories that LibRaw follows from the header, and texts are as long as it reads them, up
/// to 63 letters, whatever length is stated. In another container, where Hasselblad makes none, the name is a fault.
std::string raw_fault(const std::filesystem::path& file);

}  // namespace lensproof::formats
