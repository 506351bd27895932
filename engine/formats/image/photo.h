// engine/formats/image/photo.h — a photograph as a measurement needs it: the sensor's rows, linear light, and what the
// camera noted.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/formats/image/image.h"
#include "engine/formats/image/transfer_curve.h"

namespace lensproof::formats {

/// What the camera wrote beside the picture (EXIF, DNG). What it does not say is empty.
struct CameraNotes {
    std::string make;
    std::string model;
    std::string lens;
    std::string software;
    std::optional<double> focal_length_mm;
    std::optional<double> equivalent_focal_length_mm;  // on 36 × 24 mm, rounded to whole mm by cameras
    std::optional<double> f_number;
    std::optional<double> exposure_time_s;
    std::optional<double> iso;
    std::optional<double> pixel_pitch_um;  // of the focal plane's resolution
    std::string transfer;                  // the curve taken, and whether the file states it

    /// Diagonal of 36 × 24 mm over the sensor's, from the equivalent focal length.
    [[nodiscard]] std::optional<double> crop_factor() const;

    friend bool operator==(const CameraNotes&, const CameraNotes&) = default;
};

struct PhotoHeader {
    int width = 0;  // as stored: along the sensor's rows
    int height = 0;
    int orientation = 1;  // EXIF's: how the picture is to be turned to be looked at
    CameraNotes notes;
    /// Signs that the picture is no longer as the lens drew it, each a sentence's part: "the XMP data say …".
    std::vector<std::string> suspicions;
};

/// Reads what stands beside the pixels. Throws InputError as read_photo does.
///
/// `assumed` is the curve of files that state none; without it sRGB. Float files are linear. A file states its curve by
/// PNG's gAMA, by EXIF's ColorSpace = sRGB, or by being RAW.
PhotoHeader read_photo_header(const std::filesystem::path& file, const std::optional<TransferCurve>& assumed);

/// Reads a photograph in the sensor's own frame: EXIF's orientation says how a person held the camera, and is not
/// applied, so that the pictures of one camera agree about its principal point however they were held.
///
/// RAW files (OpenImageIO's reader, LibRaw): the sensor's own colours, linear; no white balance (which would clip), no
/// automatic brightness, no colour matrix, no turning, each colour interpolated from its own pixels alone (bilinear:
/// the better-looking methods let green decide where red and blue edges lie). Corrections that a DNG lists for its
/// reader (opcodes) are not applied.
/// Throws InputError as read_image does.
Image read_photo(const std::filesystem::path& file, const std::optional<TransferCurve>& assumed);

/// Whether the name ends as a picture's does (.jpg, .png, .tif, .exr, .dng, .cr2, …).
bool has_picture_name(const std::filesystem::path& file);

}  // namespace lensproof::formats
