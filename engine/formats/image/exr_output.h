// engine/formats/image/exr_output.h — OpenEXR files through OpenImageIO, of which every byte is known to be written.
#pragma once
#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <functional>
#include <string>

namespace lensproof::formats {

/// Lets `write` open an OpenEXR writer by the name of a temporary file, fill and close it; `write` returns whether the
/// library was content. `file` appears whole or not at all. Throws std::runtime_error where it cannot be written.
void write_exr_file(const std::filesystem::path& file,
                    const std::function<bool(OIIO::ImageOutput& output, const std::string& name)>& write);

}  // namespace lensproof::formats
