// engine/formats/image/confined_picture.h — a picture that a confined process decodes.
#pragma once
#include <OpenImageIO/imageio.h>

#include <filesystem>

#include "engine/formats/image/picture_file.h"

namespace lensproof::formats {

/// What `open` (open_picture without distrust) opens, with the library at work in a confined process
/// (engine/base/confined.h): the same pixels and notes, in scanlines where the file has tiles.
OpenPicture open_confined(const std::filesystem::path& file, const OIIO::ImageSpec& hints);

}  // namespace lensproof::formats
