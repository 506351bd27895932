#include "engine/formats/image/picture_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>

#include "engine/base/confined.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/memory.h"
#include "engine/base/text.h"
#include "engine/formats/image/confined_picture.h"
#include "engine/formats/image/image.h"
#include "engine/formats/image/jpeg.h"
#include "engine/formats/image/raw_fault.h"
#include "engine/formats/image/stated_sizes.h"

namespace lensproof::formats {

namespace {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

constexpr double kMostPixels = 200e6;
constexpr double kAnyFilesNumbers = 1 << 26;  // 256 MiB of floats
constexpr double kMostNumbersPerByte = 300.0;
constexpr double kMib = 1 << 20;

constexpr std::array kRawExtensions = {".dng", ".cr2", ".cr3", ".crw", ".nef", ".nrw", ".arw", ".sr2", ".srf",
                                       ".raf", ".orf", ".rw2", ".rwl", ".pef", ".srw", ".x3f", ".3fr", ".fff",
                                       ".iiq", ".mos", ".mrw", ".erf", ".kdc", ".dcr", ".mef", ".raw"};

/// Bytes that stand at a place of files of a form.
struct Mark {
    std::size_t at;
    std::string_view bytes;
    PictureForm form;
};

// The first that fits. Raw files that begin as TIFF do, of whatever maker, come last and go by their names.
constexpr std::array kMarks = {Mark{0, "\xFF\xD8\xFF"sv, PictureForm::jpeg},
                               Mark{0, "\x89PNG\r\n\x1A\n"sv, PictureForm::png},
                               Mark{0, "\x76\x2F\x31\x01"sv, PictureForm::exr},
                               Mark{0, "#?RADIANCE"sv, PictureForm::hdr},
                               Mark{0, "#?RGBE"sv, PictureForm::hdr},
                               Mark{8, "CR\2\0"sv, PictureForm::raw},           // CR2
                               Mark{4, "ftypcrx "sv, PictureForm::raw},         // CR3
                               Mark{6, "HEAPCCDR"sv, PictureForm::raw},         // CRW
                               Mark{0, "FUJIFILMCCD-RAW"sv, PictureForm::raw},  // RAF
                               Mark{0, "IIRO"sv, PictureForm::raw},             // ORF
                               Mark{0, "IIRS"sv, PictureForm::raw},
                               Mark{0, "MMOR"sv, PictureForm::raw},
                               Mark{0, "IIU\0"sv, PictureForm::raw},  // RW2, RWL
                               Mark{0, "FOVb"sv, PictureForm::raw},   // X3F
                               Mark{0, "\0MRM"sv, PictureForm::raw},  // MRW
                               Mark{0, "IIII"sv, PictureForm::raw},   // IIQ
                               Mark{0, "MMMM"sv, PictureForm::raw},
                               Mark{0, "II*\0"sv, PictureForm::tiff},
                               Mark{0, "MM\0*"sv, PictureForm::tiff},
                               Mark{0, "II+\0"sv, PictureForm::tiff},  // BigTIFF
                               Mark{0, "MM\0+"sv, PictureForm::tiff}};

const char* reader_of(PictureForm form) {
    switch (form) {
        case PictureForm::jpeg:
            return "jpeg";
        case PictureForm::png:
            return "png";
        case PictureForm::tiff:
            return "tiff";
        case PictureForm::exr:
            return "openexr";
        case PictureForm::hdr:
            return "hdr";
        case PictureForm::raw:
            return "raw";
    }
    return "";
}

/// What a tile's or a strip's rounding up makes of a side.
double rounded_up(int side, int tile) {
    return tile > 0 ? std::ceil(static_cast<double>(side) / tile) * tile : side;
}

}  // namespace

std::optional<PictureForm> picture_form(const fs::path& file) {
    check_readable(file);
    if (!fs::is_regular_file(file)) {
        throw InputError(fmt::format("{}: is a device or a pipe, expected a picture's file", file.string()));
    }
    std::string head(16, '\0');
    std::ifstream stream(file, std::ios::binary);
    stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(stream.gcount()));
    const auto found = std::ranges::find_if(kMarks, [&](const Mark& mark) {
        return head.size() > mark.at && head.substr(mark.at).starts_with(mark.bytes);
    });
    if (found == kMarks.end()) {
        return std::nullopt;
    }
    return found->form == PictureForm::tiff && has_raw_name(file) ? PictureForm::raw : found->form;
}

bool has_raw_name(const fs::path& file) {
    return std::ranges::find(kRawExtensions, lower_extension(file)) != kRawExtensions.end();
}

OpenPicture open_picture(const fs::path& file, const OIIO::ImageSpec& hints) {
    return files_are_distrusted() ? open_confined(file, hints) : open_picture_here(file, hints);
}

OpenPicture open_picture_here(const fs::path& file, const OIIO::ImageSpec& hints) {
    const std::optional<PictureForm> form = picture_form(file);
    if (!form) {
        throw InputError(fmt::format(
            "{}: not a picture that can be read, expected JPEG, PNG, TIFF, EXR, HDR (Radiance) or a camera's raw file",
            file.string()));
    }
    const std::string fault = *form == PictureForm::exr    ? exr_fault(file)
                              : *form == PictureForm::png  ? png_fault(file)
                              : *form == PictureForm::jpeg ? jpeg_fault(read_file(file))
                              : *form == PictureForm::raw  ? raw_fault(file)
                                                           : "";
    if (!fault.empty()) {
        throw InputError(fmt::format("{}: not a picture that can be read: {}", file.string(), fault));
    }
    OpenPicture picture{.form = *form, .input = OIIO::ImageInput::create(reader_of(*form))};
    OIIO::ImageSpec spec;
    if (!picture.input || !picture.input->open(file.string(), spec, hints)) {
        throw InputError(fmt::format("{}: not a picture that can be read: {}", file.string(),
                                     on_one_line(picture.input ? picture.input->geterror() : OIIO::geterror())));
    }
    return picture;
}

void check_picture_size(const fs::path& file, const OIIO::ImageSpec& spec, double numbers_per_pixel,
                        double bytes_per_pixel) {
    const std::string size = fmt::format("{}: {} × {} pixels", file.string(), spec.width, spec.height);
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.deep) {
        throw InputError(fmt::format("{} with {} channels, expected a flat picture", size, spec.nchannels));
    }
    const double pixels = rounded_up(spec.width, spec.tile_width) * rounded_up(spec.height, spec.tile_height);
    const double numbers = pixels * numbers_per_pixel;
    const double mib = pixels * bytes_per_pixel / kMib;
    if (const std::optional<double> largest = largest_picture_mib()) {
        if (mib > *largest) {
            throw InputError(
                fmt::format("{} take {:.0f} MiB, expected at most the {:g} of --largest-picture", size, mib, *largest));
        }
        return;
    }
    if (pixels > kMostPixels) {
        throw InputError(fmt::format("{}, expected at most {:.0f} million, or --largest-picture {:.0f}", size,
                                     kMostPixels / 1e6, std::ceil(mib)));
    }
    const auto bytes = static_cast<double>(fs::file_size(file));
    if (numbers > kAnyFilesNumbers && numbers > kMostNumbersPerByte * bytes) {
        throw InputError(
            fmt::format("{} with {} numbers each out of {:.0f} bytes, expected at most {:g} numbers a byte, or "
                        "--largest-picture {:.0f}",
                        size, numbers_per_pixel, bytes, kMostNumbersPerByte, std::ceil(mib)));
    }
    const double half = memory_bytes() / 2.0 / kMib;
    if (mib > half) {
        throw InputError(
            fmt::format("{} take {:.0f} MiB, expected at most {:.0f}, half of the memory that there is, or "
                        "--largest-picture {:.0f}",
                        size, mib, half, std::ceil(mib)));
    }
}

std::string on_one_line(std::string message) {
    while (!message.empty() && message.back() == '\n') {
        message.pop_back();
    }
    std::ranges::replace(message, '\n', ';');
    return printable(message);
}

std::optional<double>& largest_picture_mib() {
    static std::optional<double> mib;
    return mib;
}

}  // namespace lensproof::formats
