#include "calibration/photographed/dng_corrections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exiv2/exiv2.hpp>

#include "calibration/photographed/dng_opcodes.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/formats/image/full_frame.h"

namespace lensproof::calibration {

namespace {

constexpr double kInch_mm = 25.4;

/// What the file states, as exiv2 names it.
class Statements {
  public:
    explicit Statements(const std::filesystem::path& dng) : name_(dng.string()) {
        const std::string bytes = read_file(dng);
        Exiv2::LogMsg::setLevel(Exiv2::LogMsg::mute);
        try {
            Exiv2::IptcData iptc;
            Exiv2::XmpData xmp;
            Exiv2::TiffParser::decode(exif_, iptc, xmp, reinterpret_cast<const Exiv2::byte*>(bytes.data()),
                                      static_cast<std::uint32_t>(bytes.size()));
        } catch (const std::exception&) {  // exiv2's errors, and what the library throws where a file is damaged
            throw InputError(fmt::format("{}: is no DNG, or damaged", name_));
        }
        if (find("Exif.Image.DNGVersion") == exif_.end()) {
            throw InputError(fmt::format("{}: is no DNG, or damaged", name_));
        }
    }

    [[nodiscard]] const std::string& name() const { return name_; }

    /// The n-th number; nothing where there is none, or it is not finite.
    [[nodiscard]] std::optional<double> number(const std::string& key, long n = 0) const {
        const auto found = find(key);
        if (found == exif_.end() || static_cast<long>(found->count()) <= n) {
            return std::nullopt;
        }
        const bool is_ratio = found->typeId() == Exiv2::unsignedRational;
        const Exiv2::Rational ratio = is_ratio ? found->toRational(n) : Exiv2::Rational{};
        const double value = is_ratio ? static_cast<double>(static_cast<std::uint32_t>(ratio.first)) /
                                            static_cast<double>(static_cast<std::uint32_t>(ratio.second))
                                      : static_cast<double>(found->toFloat(n));
        return std::isfinite(value) ? std::optional(value) : std::nullopt;
    }

    /// A positive number of the EXIF, or, as TIFF/EP has it, of the first directory.
    [[nodiscard]] std::optional<double> of_photo(const std::string& name) const {
        for (const char* directory : {"Exif.Photo.", "Exif.Image."}) {
            if (const auto value = number(directory + name); value && *value > 0.0) {
                return value;
            }
        }
        return std::nullopt;
    }

    [[nodiscard]] std::string text(const std::string& key) const {
        const auto found = find(key);
        return found == exif_.end() ? "" : found->toString();
    }

    [[nodiscard]] std::string bytes(const std::string& key) const {
        const auto found = find(key);
        if (found == exif_.end()) {
            return "";
        }
        std::string bytes(static_cast<std::size_t>(found->size()), '\0');
        found->copy(reinterpret_cast<Exiv2::byte*>(bytes.data()), Exiv2::bigEndian);
        return bytes;
    }

  private:
    /// ExifData::findKey throws for keys that no such directory should have.
    [[nodiscard]] Exiv2::ExifData::const_iterator find(const std::string& key) const {
        return std::find_if(exif_.begin(), exif_.end(),
                            [&](const Exiv2::Exifdatum& datum) { return datum.key() == key; });
    }

    std::string name_;
    Exiv2::ExifData exif_;
};

/// Where the raw picture's statements stand: in the first directory, or in one below it.
std::string raw_directory(const Statements& statements) {
    constexpr double kColourFilterArray = 32803.0;
    constexpr double kLinearRaw = 34892.0;
    for (const char* directory : {"Image", "SubImage1", "SubImage2", "SubImage3", "SubImage4", "SubImage5", "SubImage6",
                                  "SubImage7", "SubImage8", "SubImage9"}) {
        std::string prefix = fmt::format("Exif.{}.", directory);
        const auto kind = statements.number(prefix + "PhotometricInterpretation");
        if (kind == kColourFilterArray || kind == kLinearRaw) {
            return prefix;
        }
    }
    throw InputError(fmt::format("{}: no raw picture in it", statements.name()));
}

/// Pixels that opcodes know of: the sensor's active area.
struct PictureSize {
    double width = 0.0;
    double height = 0.0;

    [[nodiscard]] double diagonal() const { return std::hypot(width, height); }

    /// From the centre (shares) to the farthest corner's pixel.
    [[nodiscard]] double farthest(const std::array<double, 2>& centre) const {
        return std::hypot(std::max(centre[0], 1.0 - centre[0]) * (width - 1.0),
                          std::max(centre[1], 1.0 - centre[1]) * (height - 1.0));
    }
};

PictureSize size_of(const Statements& statements, const std::string& raw) {
    PictureSize size{.width = statements.number(raw + "ImageWidth").value_or(0.0),
                     .height = statements.number(raw + "ImageLength").value_or(0.0)};
    const std::string active = raw + "ActiveArea";
    if (const auto right = statements.number(active, 3)) {
        size = {.width = *right - *statements.number(active, 1),
                .height = *statements.number(active, 2) - *statements.number(active, 0)};
    }
    if (!(size.width >= 2.0 && size.height >= 2.0)) {
        throw InputError(
            fmt::format("{}: the raw picture has {} × {} pixels", statements.name(), size.width, size.height));
    }
    return size;
}

double crop_factor_of(const Statements& statements, const PictureSize& size) {
    if (const auto resolution = statements.of_photo("FocalPlaneXResolution")) {
        const double unit = statements.of_photo("FocalPlaneResolutionUnit").value_or(2.0);
        const double unit_mm = unit == 3.0 ? 10.0 : unit == 4.0 ? 1.0 : kInch_mm;
        return formats::kFullFrameDiagonal_mm / (size.diagonal() / *resolution * unit_mm);
    }
    const auto focal_mm = statements.of_photo("FocalLength");
    const auto full_frame_mm = statements.of_photo("FocalLengthIn35mmFilm");
    if (focal_mm && full_frame_mm) {
        return *full_frame_mm / *focal_mm;
    }
    throw InputError(
        fmt::format("{}: says neither FocalPlaneXResolution nor FocalLengthIn35mmFilm, expected "
                    "--crop-factor C of its sensor",
                    statements.name()));
}

/// In a photographed lens's unit, of which `unit` make one of the opcode's.
RadialPolynomial polynomial_of(const RectilinearWarp::Plane& plane, double unit) {
    RadialPolynomial polynomial{};
    for (std::size_t i = 0; i < plane.radial.size(); ++i) {
        polynomial[2 * i] = plane.radial[i] * std::pow(unit, -2.0 * static_cast<double>(i));
    }
    return polynomial;
}

void take_warp(const RectilinearWarp& warp, double unit, double corner_um, PhotographedLens& lens) {
    const bool has_colours = warp.planes.size() == 3;
    lens.distortion_model = "warp-rectilinear";
    lens.distortion = polynomial_of(warp.planes[has_colours ? 1 : 0], unit);
    if (has_colours) {
        lens.lateral_colour =
            LateralColour{.red = polynomial_of(warp.planes[0], unit), .blue = polynomial_of(warp.planes[2], unit)};
    }
    double largest = 0.0;
    for (const RectilinearWarp::Plane& plane : warp.planes) {
        // At the corner, along the terms: 2 k x y + k (r² + 2 x²) is 3 k at most.
        largest = std::max(largest, 3.0 * std::hypot(plane.tangential[0], plane.tangential[1]));
    }
    if (largest > 0.0) {
        lens.remarks.push_back(fmt::format("tangential terms of up to {:.2g} µm are left out", largest * corner_um));
    }
}

}  // namespace

PhotographedLens read_dng_corrections(const std::filesystem::path& dng, std::optional<double> crop_factor) {
    const Statements statements(dng);
    const std::string raw = raw_directory(statements);
    LensOpcodes opcodes;
    for (const char* list : {"OpcodeList1", "OpcodeList2", "OpcodeList3"}) {
        if (const std::string bytes = statements.bytes(raw + list); !bytes.empty()) {
            read_opcodes(bytes, fmt::format("{}: {}", statements.name(), list), opcodes);
        }
    }
    if (!opcodes.warp && !opcodes.gain) {
        throw InputError(
            fmt::format("{}: corrects nothing of its lens, expected an opcode WarpRectilinear or "
                        "FixVignetteRadial",
                        statements.name()));
    }
    const PictureSize size = size_of(statements, raw);
    PhotographedLens lens{.source = "dng",
                          .maker = statements.text("Exif.Photo.LensMake"),
                          .model = statements.text("Exif.Photo.LensModel")};
    if (lens.model.empty()) {
        lens.model = dng.filename().string();
    }
    if (lens.maker.empty()) {
        lens.maker = "unknown maker";
    }
    lens.crop_factor = crop_factor ? *crop_factor : crop_factor_of(statements, size);
    lens.aspect_ratio = std::max(size.width, size.height) / std::min(size.width, size.height);
    lens.focal_length_mm = statements.of_photo("FocalLength").value_or(0.0);
    const double pixel_mm = 2.0 * lens.half_diagonal_mm() / size.diagonal();
    if (opcodes.warp) {
        const double corner_mm = size.farthest(opcodes.warp->centre) * pixel_mm;
        take_warp(*opcodes.warp, corner_mm / lens.unit_mm(), 1e3 * corner_mm, lens);
    }
    const auto f_number = statements.of_photo("FNumber");
    if (opcodes.gain && f_number) {
        const double half_diagonal = lens.half_diagonal_mm() / (size.farthest(opcodes.gain->centre) * pixel_mm);
        MeasuredVignetting vignetting{.f_number = *f_number, .k = opcodes.gain->k, .corrects = true};
        for (std::size_t i = 0; i < vignetting.k.size(); ++i) {
            vignetting.k[i] *= std::pow(half_diagonal, 2.0 * static_cast<double>(i + 1));
        }
        if (const double corner = vignetting.brightness(1.0); !(corner > 0.0 && std::isfinite(corner))) {
            throw InputError(fmt::format("{}: FixVignetteRadial multiplies the corner by {}, expected more than 0",
                                         statements.name(), 1.0 / corner));
        }
        lens.vignetting = {vignetting};
    } else if (opcodes.gain) {
        lens.remarks.emplace_back("its vignetting is left out, since the photo says no f-number");
    }
    return lens;
}

}  // namespace lensproof::calibration
