#include "engine/formats/image/stated_sizes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "engine/base/bytes.h"

namespace lensproof::formats {

namespace {

constexpr std::uint32_t kHasParts = 0x1000;  // of the version field
constexpr const char* kCutOff = "it states more than there is of it, as if it were cut off";
constexpr std::streamoff kBytesOfChannel = 16;        // the first four: of which type its pixels are
constexpr std::size_t kLongestName = 255;             // of attributes and of their types
constexpr std::array kBytesOfType = {4.0, 2.0, 4.0};  // of pixels: whole numbers, halves, floats
constexpr double kMostChunkMib = 512.0;
constexpr std::array kLinesOfChunk = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};  // by compression
constexpr std::size_t kUnstatedCompression = 3;                               // which OpenEXR takes for ZIP

/// Types of attributes whose values always take these bytes: OpenEXR's library reads as many, whatever size is stated,
/// and takes what follows for the next attribute.
constexpr std::pair<std::string_view, std::uint32_t> kTypeSizes[] = {{"box2f", 16},
                                                                     {"box2i", 16},
                                                                     {"chromaticities", 32},
                                                                     {"compression", 1},
                                                                     {"deepImageState", 1},
                                                                     {"double", 8},
                                                                     {"envmap", 1},
                                                                     {"float", 4},
                                                                     {"int", 4},
                                                                     {"keycode", 28},
                                                                     {"lineOrder", 1},
                                                                     {"m33d", 72},
                                                                     {"m33f", 36},
                                                                     {"m44d", 128},
                                                                     {"m44f", 64},
                                                                     {"rational", 8},
                                                                     {"tiledesc", 9},
                                                                     {"timecode", 8},
                                                                     {"v2d", 16},
                                                                     {"v2f", 8},
                                                                     {"v2i", 8},
                                                                     {"v3d", 24},
                                                                     {"v3f", 12},
                                                                     {"v3i", 12}};

/// Counts the chunks that headers promise.
class ExrHeaders {
  public:
    explicit ExrHeaders(const std::filesystem::path& file)
        : stream_(file, std::ios::binary), size_(static_cast<double>(std::filesystem::file_size(file))) {}

    std::string fault() {
        const auto magic = number<std::uint32_t>();
        const auto version = number<std::uint32_t>();
        if (!magic || !version) {
            return kCutOff;
        }
        double chunks = 0.0;
        for (std::optional<double> part = chunks_of_part(); part != 0.0; part = chunks_of_part()) {
            chunks += part.value_or(size_);
            if (unknown_type_) {
                return fmt::format("a channel has pixels of type {}, expected 0, 1 or 2", *unknown_type_);
            }
            if (chunk_mib_ > kMostChunkMib) {
                return fmt::format("a chunk of its pixels takes {:.0f} MiB, expected at most {}", chunk_mib_,
                                   kMostChunkMib);
            }
            if (8.0 * chunks > size_) {
                return kCutOff;
            }
            if ((*version & kHasParts) == 0) {
                break;
            }
        }
        return {};
    }

  private:
    template <class Number>
    std::optional<Number> number() {
        std::string bytes(sizeof(Number), '\0');
        stream_.read(bytes.data(), sizeof(Number));
        std::string_view rest = bytes;
        return stream_ ? take_bytes<Number>(rest) : std::nullopt;
    }

    std::string name() {
        std::string text;
        for (int c = stream_.get(); c > 0 && text.size() <= kLongestName; c = stream_.get()) {
            text += static_cast<char>(c);
        }
        return text;
    }

    /// What the value that begins here takes by its type and its own counts; `size` where those say nothing.
    double length_of(const std::string& type, std::uint32_t size) {
        const auto* fixed = std::ranges::find(kTypeSizes, type, &std::pair<std::string_view, std::uint32_t>::first);
        if (fixed != std::end(kTypeSizes)) {
            return fixed->second;
        }
        double length = 0.0;
        if (type == "chlist") {  // names and 16 bytes each, up to a name of nothing
            for (std::string channel = name(); !channel.empty() && length < size; channel = name()) {
                length += static_cast<double>(channel.size()) + 1 + kBytesOfChannel;
                const auto pixels = number<std::uint32_t>();
                if (pixels && *pixels >= kBytesOfType.size()) {
                    unknown_type_ = pixels;
                }
                pixel_bytes_ += pixels && !unknown_type_ ? kBytesOfType.at(*pixels) : 0.0;
                stream_.seekg(kBytesOfChannel - std::streamoff{sizeof(std::uint32_t)}, std::ios::cur);
            }
            return length + 1;
        }
        if (type == "preview") {  // 4 bytes a pixel
            const auto width = number<std::uint32_t>();
            const auto height = number<std::uint32_t>();
            return height ? 8.0 + 4.0 * *width * *height : 0.0;
        }
        if (type == "stringvector") {
            while (length < size) {
                const auto text = number<std::uint32_t>();
                length += 4.0 + text.value_or(size);
                stream_.seekg(text.value_or(0), std::ios::cur);
            }
            return length;
        }
        return size;
    }

    /// 0 where there is no further header; nothing where the header does not fit.
    std::optional<double> chunks_of_part() {
        double width = 0.0;
        double height = 0.0;
        double lines = kLinesOfChunk.at(kUnstatedCompression);
        double stated = 0.0;
        double tile_area = 0.0;
        bool is_empty = true;
        pixel_bytes_ = 0.0;
        for (std::string attribute = name(); !attribute.empty(); attribute = name()) {
            is_empty = false;
            const std::string type = name();
            const auto size = number<std::uint32_t>();
            const auto at = static_cast<double>(stream_.tellg());
            if (!size || at + *size > size_ || length_of(type, *size) != *size) {
                return std::nullopt;
            }
            stream_.clear();
            stream_.seekg(static_cast<std::streamoff>(at));
            if (attribute == "dataWindow") {
                const auto left = number<std::int32_t>();
                const auto top = number<std::int32_t>();
                const auto right = number<std::int32_t>();
                const auto bottom = number<std::int32_t>();
                width = bottom ? double{1} + *right - *left : 0.0;
                height = bottom ? double{1} + *bottom - *top : 0.0;
            } else if (attribute == "compression") {
                const auto kind = number<std::uint8_t>().value_or(0);
                lines = kind < kLinesOfChunk.size() ? kLinesOfChunk.at(kind) : 1;
            } else if (attribute == "tiles") {
                const auto across = number<std::uint32_t>();
                const auto down = number<std::uint32_t>();
                tile_area = down ? static_cast<double>(*across) * *down : 0.0;
            } else if (attribute == "chunkCount") {
                stated = number<std::uint32_t>().value_or(0);
            }
            stream_.clear();
            stream_.seekg(static_cast<std::streamoff>(at + *size));
        }
        if (is_empty) {
            return 0.0;
        }
        chunk_mib_ = pixel_bytes_ * (tile_area > 0.0 ? tile_area : width * lines) / 0x1p20;
        const double counted = tile_area > 0.0 ? width * height / tile_area : height / lines;
        return std::max({1.0, stated, counted});
    }

    std::ifstream stream_;
    double size_;
    std::optional<std::uint32_t> unknown_type_;
    double pixel_bytes_ = 0.0;  // of a part's channels
    double chunk_mib_ = 0.0;    // of the last part
};

}  // namespace

std::string exr_fault(const std::filesystem::path& file) {
    return ExrHeaders(file).fault();
}

std::string png_fault(const std::filesystem::path& file) {
    constexpr std::uintmax_t kSignature = 8;
    constexpr std::uintmax_t kAround = 12;  // length, type and checksum
    const std::uintmax_t size = std::filesystem::file_size(file);
    std::ifstream stream(file, std::ios::binary);
    for (std::uintmax_t at = kSignature; at < size;) {
        std::array<unsigned char, 8> head{};
        stream.seekg(static_cast<std::streamoff>(at));
        stream.read(reinterpret_cast<char*>(head.data()), head.size());
        const std::uintmax_t length = (std::uintmax_t{head[0]} << 24U) + (std::uintmax_t{head[1]} << 16U) +
                                      (std::uintmax_t{head[2]} << 8U) + head[3];
        at += kAround + length;
        if (!stream || at > size) {
            return kCutOff;
        }
        if (std::string_view(reinterpret_cast<const char*>(head.data()) + 4, 4) == "IEND") {
            break;
        }
    }
    return {};
}

}  // namespace lensproof::formats
