#include "engine/formats/image/photo.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "engine/base/file.h"
#include "engine/formats/image/stored_picture.h"

namespace lensproof::formats {

namespace {

// Those that are not read as well: a photo that is left out is named.
constexpr std::array kPictureExtensions = {".jpg", ".jpeg", ".png", ".tif",  ".tiff", ".exr",
                                           ".ppm", ".pgm",  ".bmp", ".webp", ".heic", ".hdr"};

/// What OpenImageIO is told of RAW files; other formats do not look at it.
OIIO::ImageSpec raw_hints() {
    OIIO::ImageSpec hints;
    hints.attribute("raw:ColorSpace", "raw");
    hints.attribute("raw:use_camera_wb", 0);
    const std::array<float, 4> even = {1.0F, 1.0F, 1.0F, 1.0F};
    hints.attribute("raw:user_mul", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 4), even.data());
    hints.attribute("raw:use_camera_matrix", 0);
    hints.attribute("raw:auto_bright", 0);
    hints.attribute("raw:adjust_maximum_thr", 0.0F);
    hints.attribute("raw:HighlightMode", 0);
    hints.attribute("raw:Demosaic", "linear");
    hints.attribute("raw:user_flip", 0);
    return hints;
}

std::optional<double> positive(const OIIO::ImageSpec& spec, const char* name) {
    const float value = spec.get_float_attribute(name, 0.0F);
    // To the float's own seven digits: 4.2, not 4.1999998.
    return value > 0.0F && std::isfinite(value) ? std::optional(std::stod(fmt::format("{:.7g}", value))) : std::nullopt;
}

std::string without_padding(std::string text) {
    while (!text.empty() && (text.back() == '\0' || std::isspace(static_cast<unsigned char>(text.back())) != 0)) {
        text.pop_back();
    }
    return text;
}

/// EXIF's FocalPlaneXResolution, pixels a unit, of a picture that has still the size that the camera gave it.
std::optional<double> pixel_pitch_um(const OIIO::ImageSpec& spec) {
    const auto resolution = positive(spec, "Exif:FocalPlaneXResolution");
    const int own_width = spec.get_int_attribute("Exif:PixelXDimension", spec.width);
    if (!resolution || own_width != spec.width) {
        return std::nullopt;
    }
    switch (spec.get_int_attribute("Exif:FocalPlaneResolutionUnit", 2)) {
        case 2:
            return 25400.0 / *resolution;
        case 3:
            return 10000.0 / *resolution;
        case 4:
            return 1000.0 / *resolution;
        case 5:
            return 1.0 / *resolution;
        default:
            return std::nullopt;
    }
}

struct StatedCurve {
    TransferCurve curve;
    bool stated = false;
};

StatedCurve curve_of(const OIIO::ImageSpec& spec, bool raw, const std::optional<TransferCurve>& assumed) {
    const std::string space = spec.get_string_attribute("oiio:ColorSpace");
    if (raw || spec.format.is_floating_point() || space == "linear" || space == "Linear") {
        return {{.kind = TransferKind::linear}, true};
    }
    const float gamma = stated_gamma(space);
    if (gamma > 0.0F) {
        // PNG's gAMA of 1/2.2 stands for sRGB in practice.
        return std::abs(gamma - 2.2F) <= 0.05F
                   ? StatedCurve{{.kind = TransferKind::srgb}, true}
                   : StatedCurve{{.kind = TransferKind::gamma, .gamma = static_cast<double>(gamma)}, true};
    }
    if (spec.get_int_attribute("Exif:ColorSpace", 0) == 1) {
        return {{.kind = TransferKind::srgb}, true};
    }
    return {assumed.value_or(TransferCurve{}), false};
}

CameraNotes notes_of(const OIIO::ImageSpec& spec, bool raw, const std::optional<TransferCurve>& assumed) {
    CameraNotes notes{.make = without_padding(spec.get_string_attribute("Make")),
                      .model = without_padding(spec.get_string_attribute("Model")),
                      .lens = without_padding(spec.get_string_attribute("Exif:LensModel")),
                      .software = without_padding(spec.get_string_attribute("Software")),
                      .focal_length_mm = positive(spec, "Exif:FocalLength"),
                      .equivalent_focal_length_mm = positive(spec, "Exif:FocalLengthIn35mmFilm"),
                      .f_number = positive(spec, "FNumber"),
                      .exposure_time_s = positive(spec, "ExposureTime"),
                      .iso = positive(spec, "Exif:PhotographicSensitivity"),
                      .pixel_pitch_um = pixel_pitch_um(spec),
                      .transfer = {}};
    if (!notes.iso) {
        notes.iso = positive(spec, "Exif:ISOSpeedRatings");
    }
    const StatedCurve curve = curve_of(spec, raw, assumed);
    notes.transfer = to_text(curve.curve) + (curve.stated ? " (stated by the file)" : " (assumed)");
    return notes;
}

bool says_yes(const OIIO::ImageSpec& spec, const char* name) {
    const std::string value = spec.get_string_attribute(name);
    return value == "1" || value == "True" || value == "true" || spec.get_int_attribute(name, 0) == 1;
}

std::vector<std::string> suspicions_of(const OIIO::ImageSpec& spec) {
    std::vector<std::string> signs;
    if (says_yes(spec, "crs:LensProfileEnable")) {
        signs.emplace_back("the XMP data say that a raw converter applied a lens profile (crs:LensProfileEnable)");
    }
    if (says_yes(spec, "crs:AutoLateralCA")) {
        signs.emplace_back("the XMP data say that a raw converter removed chromatic shift (crs:AutoLateralCA)");
    }
    if (spec.get_float_attribute("crs:LensManualDistortionAmount", 0.0F) != 0.0F ||
        spec.get_string_attribute("crs:LensManualDistortionAmount", "0") != "0") {
        signs.emplace_back(
            "the XMP data say that a raw converter corrected distortion (crs:LensManualDistortionAmount)");
    }
    const int own_width = spec.get_int_attribute("Exif:PixelXDimension", 0);
    const int own_height = spec.get_int_attribute("Exif:PixelYDimension", 0);
    if (own_width > 0 && own_height > 0 && (own_width != spec.width || own_height != spec.height)) {
        signs.push_back(
            fmt::format("the camera's picture had {} × {} pixels, this one has {} × {}: cropped, turned or "
                        "scaled since",
                        own_width, own_height, spec.width, spec.height));
    }
    if (const auto zoom = positive(spec, "Exif:DigitalZoomRatio"); zoom && *zoom > 1.0) {
        signs.push_back(fmt::format("digital zoom of {:g}: cropped and enlarged in the camera", *zoom));
    }
    if (spec.get_int_attribute("Exif:CustomRendered", 0) != 0) {
        signs.emplace_back("EXIF's CustomRendered is set: processed in the camera beyond the usual");
    }
    const double longer = std::max(spec.width, spec.height);
    if (std::abs(longer / std::min(spec.width, spec.height) - 16.0 / 9.0) < 0.01 &&
        !spec.get_string_attribute("Model").empty()) {
        signs.emplace_back("the picture is 16:9, few sensors are: cropped in the camera");
    }
    return signs;
}

/// Bytes by a table: a picture has millions, and 256 values.
void linearise(std::vector<float>& values, const TransferCurve& curve, const OIIO::TypeDesc& stored_as) {
    struct Known {
        float value = -1.0F;
        float light = 0.0F;
    };
    std::array<Known, 256> known;
    const bool is_bytes = stored_as == OIIO::TypeDesc::UINT8;
    for (float& value : values) {
        if (!is_bytes || !(value >= 0.0F && value <= 1.0F)) {
            value = to_linear(curve, value);
            continue;
        }
        Known& own = known[static_cast<std::size_t>(std::lround(255.0F * value))];
        if (own.value != value) {
            own = {value, to_linear(curve, value)};
        }
        value = own.light;
    }
}

}  // namespace

std::optional<double> CameraNotes::crop_factor() const {
    return focal_length_mm && equivalent_focal_length_mm ? std::optional(*equivalent_focal_length_mm / *focal_length_mm)
                                                         : std::nullopt;
}

PhotoHeader read_photo_header(const std::filesystem::path& file, const std::optional<TransferCurve>& assumed) {
    const auto [spec, form] = read_header(file, raw_hints());
    return {.width = spec.width,
            .height = spec.height,
            .orientation = spec.get_int_attribute("Orientation", 1),
            .notes = notes_of(spec, form == PictureForm::raw, assumed),
            .suspicions = suspicions_of(spec)};
}

Image read_photo(const std::filesystem::path& file, const std::optional<TransferCurve>& assumed) {
    StoredPicture stored = read_stored(file, raw_hints());
    const TransferCurve curve = curve_of(stored.spec, stored.form == PictureForm::raw, assumed).curve;
    if (curve.kind != TransferKind::linear) {
        linearise(stored.image.pixels, curve, stored.spec.format);
    }
    return std::move(stored.image);
}

bool has_picture_name(const std::filesystem::path& file) {
    return has_raw_name(file) ||
           std::ranges::find(kPictureExtensions, lower_extension(file)) != kPictureExtensions.end();
}

}  // namespace lensproof::formats
