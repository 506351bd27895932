// engine/formats/image/picture_file.h — the one door through which pictures' files are opened.
#pragma once
#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace lensproof::formats {

enum class PictureForm { jpeg, png, tiff, exr, hdr, raw };

/// What the file's first bytes say that it is, whatever its name; none where it is none of these. The name decides only
/// where a camera's raw form is built on TIFF and begins like any other.
std::optional<PictureForm> picture_form(const std::filesystem::path& file);

/// Whether the name ends as a camera's raw files do (.dng, .cr2, …).
bool has_raw_name(const std::filesystem::path& file);

/// A picture whose header has been read.
struct OpenPicture {
    PictureForm form = PictureForm::jpeg;
    std::unique_ptr<OIIO::ImageInput> input;
};

/// Opens the file with OpenImageIO's reader of its form, and no other: left to itself the library tries all that it
/// has, on files of any content, and some write beyond their buffers. `hints` are the library's (raw:…).
///
/// Throws InputError for a file that is missing or not of these forms, or whose header is damaged; for a JPEG that is
/// cut off (the library would fill what is missing with grey and say nothing), or has more than 100 scans; and for what
/// the library would not survive (stated_sizes.h, jpeg.h, raw_fault.h).
///
/// Where files are distrusted (engine/base/confined.h), a confined process decodes it.
OpenPicture open_picture(const std::filesystem::path& file, const OIIO::ImageSpec& hints);

/// The same in this process, whatever its file is.
OpenPicture open_picture_here(const std::filesystem::path& file, const OIIO::ImageSpec& hints);

/// Throws InputError where the file's picture, of `spec`'s size, takes more than `largest_picture_mib` allows; and
/// where it is not flat.
void check_picture_size(const std::filesystem::path& file, const OIIO::ImageSpec& spec, double numbers_per_pixel,
                        double bytes_per_pixel);

/// The library's message as a part of ours.
std::string on_one_line(std::string message);

}  // namespace lensproof::formats
