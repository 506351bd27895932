#include "engine/formats/image/jpeg.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "engine/formats/image/srgb.h"

namespace lensproof::formats {

namespace {

constexpr std::size_t kCoefficients = 64;
// Table K.1, in the zigzag order that files have.
constexpr std::array<int, kCoefficients> kLuminance = {
    16, 11,  12, 14, 12, 10, 16,  14,  13,  14, 18, 17,  16,  19,  24,  40,  26, 24,  22,  22, 24, 49,
    35, 37,  29, 40, 58, 51, 61,  60,  57,  51, 56, 55,  64,  72,  92,  78,  64, 68,  87,  69, 55, 56,
    80, 109, 81, 87, 95, 98, 103, 104, 103, 62, 77, 113, 121, 112, 100, 120, 92, 101, 103, 99};

using Table = std::array<int, kCoefficients>;

int byte_at(std::string_view bytes, std::size_t place) {
    return place < bytes.size() ? static_cast<unsigned char>(bytes[place]) : 0;
}

/// Table 0 of a DQT segment's content (B.2.4.1); none where it holds others only, or is cut off.
std::optional<Table> first_table(std::string_view content) {
    for (std::size_t at = 0; at < content.size();) {
        const std::size_t width = byte_at(content, at) >> 4 != 0 ? 2 : 1;  // bytes of an entry
        const bool is_first = (byte_at(content, at) & 15) == 0;
        ++at;
        if (is_first && at + width * kCoefficients <= content.size()) {
            Table table{};
            for (int& entry : table) {
                entry = width == 2 ? 256 * byte_at(content, at) + byte_at(content, at + 1) : byte_at(content, at);
                at += width;
            }
            return table;
        }
        at += width * kCoefficients;
    }
    return std::nullopt;
}

/// Segments follow one another up to the first scan (B.1.1).
std::optional<Table> luminance_table(std::string_view file) {
    if (!file.starts_with("\xFF\xD8")) {
        return std::nullopt;
    }
    constexpr int kDqt = 0xDB;
    constexpr int kScan = 0xDA;
    for (std::size_t at = 2; at + 4 <= file.size() && byte_at(file, at) == 0xFF;) {
        const int marker = byte_at(file, at + 1);
        const int length = 256 * byte_at(file, at + 2) + byte_at(file, at + 3);
        if (marker == kScan || length < 2) {
            break;
        }
        if (marker == kDqt) {
            if (const auto table = first_table(file.substr(at + 4, static_cast<std::size_t>(length) - 2))) {
                return table;
            }
        }
        at += 2 + static_cast<std::size_t>(length);
    }
    return std::nullopt;
}

/// libjpeg's rule: half the quality doubles an entry below 50, and none is left of it at 100.
int scaled(int entry, int quality) {
    const int percent = quality < 50 ? 5000 / quality : 200 - 2 * quality;
    return std::clamp((entry * percent + 50) / 100, 1, 255);
}

}  // namespace

std::optional<int> jpeg_quality(std::string_view file) {
    const std::optional<Table> table = luminance_table(file);
    if (!table) {
        return std::nullopt;
    }
    int best = 0;
    double least = 0.0;
    for (int quality = 1; quality <= 100; ++quality) {
        double apart = 0.0;
        for (std::size_t i = 0; i < kCoefficients; ++i) {
            apart += std::abs(std::log(scaled(kLuminance[i], quality) / static_cast<double>(std::max(1, (*table)[i]))));
        }
        if (best == 0 || apart <= least) {
            best = quality;
            least = apart;
        }
    }
    return best;
}

bool is_cut_off(std::string_view file) {
    const std::size_t end = file.rfind("\xFF\xD9");
    return end == std::string_view::npos || end < file.size() / 2;
}

int scan_count(std::string_view file) {
    constexpr int kScan = 0xDA;
    constexpr int kEnd = 0xD9;
    int scans = 0;
    // From mark to mark, over what a scan's bytes are between (B.1.1): those hold no 0xFF but before a 0 or a restart.
    for (std::size_t at = file.find('\xFF', 2); at < file.size(); at = file.find('\xFF', at)) {
        const int marker = byte_at(file, at + 1);
        if (marker == kEnd) {
            break;
        }
        scans += marker == kScan ? 1 : 0;
        const bool is_alone = marker <= 1 || (marker >= 0xD0 && marker <= 0xD8);
        const std::size_t content = is_alone ? 0 : 256 * byte_at(file, at + 2) + byte_at(file, at + 3);
        at += marker == 0xFF ? 1 : 2 + content;
    }
    return scans;
}

Image after_jpeg(const Image& image, int quality) {
    std::vector<unsigned char> values(image.pixels.size());
    std::ranges::transform(image.pixels, values.begin(), linear_to_srgb_byte);
    OIIO::ImageSpec spec(image.width, image.height, image.channel_count(), OIIO::TypeDesc::UINT8);
    spec.attribute("compression", fmt::format("jpeg:{}", quality));
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput sink(bytes);
    const auto output = OIIO::ImageOutput::create("jpeg", &sink);
    if (!output || !output->open("picture.jpg", spec) || !output->write_image(spec.format, values.data()) ||
        !output->close()) {
        throw std::runtime_error(
            fmt::format("a JPEG cannot be made: {}", output ? output->geterror() : OIIO::geterror()));
    }
    OIIO::Filesystem::IOMemReader source(bytes.data(), bytes.size());
    const auto input = OIIO::ImageInput::create("jpeg");
    OIIO::ImageSpec read;
    if (!input || !input->set_ioproxy(&source) || !input->open("picture.jpg", read) ||
        !input->read_image(0, 0, 0, image.channel_count(), spec.format, values.data())) {
        throw std::runtime_error(
            fmt::format("a JPEG just made cannot be read: {}", input ? input->geterror() : OIIO::geterror()));
    }
    Image result = image;
    std::array<float, 256> light{};
    for (std::size_t i = 0; i < light.size(); ++i) {
        light[i] = srgb_to_linear(static_cast<float>(i) / 255.0F);
    }
    std::ranges::transform(values, result.pixels.begin(), [&](unsigned char value) { return light[value]; });
    return result;
}

}  // namespace lensproof::formats
