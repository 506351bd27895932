// engine/formats/image/stored_picture.h — a picture's file as OpenImageIO gives it, for this room's readers.
#pragma once
#include <OpenImageIO/imageio.h>

#include <filesystem>

#include "engine/formats/image/image.h"
#include "engine/formats/image/picture_file.h"

namespace lensproof::formats {

/// The file's values as they are stored, full scale 1 where they are integers: neither turned nor linearised.
struct StoredPicture {
    Image image;           // without metadata; an alpha channel is dropped
    OIIO::ImageSpec spec;  // the file's
    PictureForm form = PictureForm::jpeg;
};

/// What a file says beside its pixels.
struct StoredHeader {
    OIIO::ImageSpec spec;
    PictureForm form = PictureForm::jpeg;
};

/// Throws InputError as read_image says. `hints` are the library's for the file's format (raw:…).
StoredPicture read_stored(const std::filesystem::path& file, const OIIO::ImageSpec& hints);

/// The same without the pixels, checked for a size that can be read.
StoredHeader read_header(const std::filesystem::path& file, const OIIO::ImageSpec& hints);

/// Turns a picture as its EXIF orientation (1 to 8) says it is to be seen.
Image turned(Image image, int orientation);

/// What every curve needs of the colour space that OpenImageIO names: its gamma where it is a bare one ("Gamma1.8").
float stated_gamma(const std::string& colour_space);

}  // namespace lensproof::formats
