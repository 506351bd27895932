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

using namespace std::string_view_literals;

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

/// Calls see(marker, content) for each mark with the content of its segment, which of some is empty, up to the end or
/// until it says false. From mark to mark, over what a scan's bytes are between (B.1.1): those hold no 0xFF but before
/// a 0 or a restart.
template <class See>
void for_each_segment(std::string_view file, const See& see) {
    constexpr int kEnd = 0xD9;
    for (std::size_t at = file.find('\xFF', 2); at < file.size(); at = file.find('\xFF', at)) {
        const int marker = byte_at(file, at + 1);
        if (marker == 0xFF) {
            ++at;
            continue;
        }
        const bool is_alone = marker <= 1 || (marker >= 0xD0 && marker <= 0xD8);
        const std::size_t length = is_alone ? 0 : 256 * byte_at(file, at + 2) + byte_at(file, at + 3);
        const std::size_t content = std::min(at + 4, file.size());
        if (marker == kEnd || !see(marker, file.substr(content, length > 2 ? length - 2 : 0))) {
            return;
        }
        at += 2 + length;
    }
}

constexpr int kScan = 0xDA;

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

/// Before the first scan.
std::optional<Table> luminance_table(std::string_view file) {
    constexpr int kDqt = 0xDB;
    std::optional<Table> table;
    if (file.starts_with("\xFF\xD8")) {
        for_each_segment(file, [&](int marker, std::string_view content) {
            table = marker == kDqt ? first_table(content) : std::nullopt;
            return marker != kScan && !table;
        });
    }
    return table;
}

/// The reader compares names with texts that end in a 0, and takes an IPTC block for as long as it says that it is,
/// however short the segment is.
std::string metadata_fault(int marker, std::string_view content) {
    constexpr int kApp1 = 0xE1;
    constexpr int kApp13 = 0xED;
    if (marker == kApp1 && (content == "Exif"sv || content == "http://ns.adobe.com/xap/1.0/"sv)) {
        return "metadata that end within their name";
    }
    constexpr std::string_view kIptc =
        "Photoshop 3.0\0"
        "8BIM\4\4"sv;
    constexpr std::size_t kHead = kIptc.size() + 4;  // then two bytes say the length
    if (marker != kApp13 || kIptc.substr(0, content.size()) != content.substr(0, kIptc.size())) {
        return "";
    }
    const std::size_t stated = 256 * byte_at(content, kHead) + byte_at(content, kHead + 1);
    return kHead + 2 + stated <= content.size()
               ? ""
               : fmt::format("an IPTC block of {} bytes in a segment of {}", stated, content.size());
}

/// The last mark (EOI) comes late in the file; that of the small picture in its header comes early.
bool is_cut_off(std::string_view file) {
    const std::size_t end = file.rfind("\xFF\xD9");
    return end == std::string_view::npos || end < file.size() / 2;
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

std::string jpeg_fault(std::string_view file) {
    constexpr int kMostScans = 100;  // libjpeg writes 10
    if (is_cut_off(file)) {
        return "the file is cut off: a JPEG without its end";
    }
    int scans = 0;
    std::string fault;
    for_each_segment(file, [&](int marker, std::string_view content) {
        scans += marker == kScan ? 1 : 0;
        fault = metadata_fault(marker, content);
        return fault.empty();
    });
    return scans <= kMostScans ? fault : fmt::format("a JPEG of {} scans, expected at most {}", scans, kMostScans);
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
