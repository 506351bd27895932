// A DNG without pixels, written by hand: three directories of a little-endian TIFF, and opcodes, which are big-endian.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lensproof::calibration::synthetic {

inline std::string big_endian(std::uint64_t value, int bytes) {
    std::string text;
    for (int i = bytes - 1; i >= 0; --i) {
        text += static_cast<char>(value >> (8 * i) & 0xFF);
    }
    return text;
}

inline std::string big_endian(std::span<const double> values) {
    std::string text;
    for (const double value : values) {
        text += big_endian(std::bit_cast<std::uint64_t>(value), 8);
    }
    return text;
}

inline std::string little_endian(std::uint64_t value, int bytes) {
    std::string text = big_endian(value, bytes);
    std::reverse(text.begin(), text.end());
    return text;
}

inline std::string opcode(std::uint32_t id, const std::string& values) {
    return big_endian(id, 4) + big_endian(0x01030000, 4) + big_endian(0, 4) + big_endian(values.size(), 4) + values;
}

/// Six numbers a plane, then the centre.
inline std::string warp_opcode(std::uint32_t planes, std::span<const double> values) {
    return opcode(1, big_endian(planes, 4) + big_endian(values));
}

inline std::string opcode_list(const std::vector<std::string>& opcodes) {
    std::string list = big_endian(opcodes.size(), 4);
    for (const std::string& one : opcodes) {
        list += one;
    }
    return list;
}

/// An entry of a TIFF's directory, its value as it lies in the file.
struct TiffEntry {
    int tag = 0;
    int type = 0;  // 1 byte, 2 text, 3 short, 4 long, 5 ratio, 7 undefined
    int count = 0;
    std::string value;
};

inline TiffEntry tiff_long(int tag, std::uint32_t value) {
    return {.tag = tag, .type = 4, .count = 1, .value = little_endian(value, 4)};
}
inline TiffEntry tiff_ratio(int tag, std::uint32_t over, std::uint32_t under) {
    return {.tag = tag, .type = 5, .count = 1, .value = little_endian(over, 4) + little_endian(under, 4)};
}
inline TiffEntry tiff_text(int tag, const std::string& text) {
    return {.tag = tag, .type = 2, .count = static_cast<int>(text.size()) + 1, .value = text + '\0'};
}
inline TiffEntry tiff_bytes(int tag, const std::string& bytes) {
    return {.tag = tag, .type = 7, .count = static_cast<int>(bytes.size()), .value = bytes};
}

/// A directory that lies at `at`, with its values behind it; entries in the order of their tags.
inline std::string directory(std::size_t at, const std::vector<TiffEntry>& entries) {
    std::string head = little_endian(entries.size(), 2);
    std::string values;
    const std::size_t values_at = at + 2 + 12 * entries.size() + 4;
    for (const TiffEntry& entry : entries) {
        head += little_endian(static_cast<std::uint64_t>(entry.tag), 2) +
                little_endian(static_cast<std::uint64_t>(entry.type), 2) +
                little_endian(static_cast<std::uint64_t>(entry.count), 4);
        if (entry.value.size() <= 4) {
            head += entry.value + std::string(4 - entry.value.size(), '\0');
        } else {
            head += little_endian(values_at + values.size(), 4);
            values += entry.value + std::string(entry.value.size() % 2, '\0');
        }
    }
    return head + little_endian(0, 4) + values;
}

struct Dng {
    std::uint32_t width = 6000;
    std::uint32_t height = 4000;
    std::string opcodes;  // of OpcodeList3
    std::vector<TiffEntry> photo{tiff_ratio(0x829D, 8, 1), tiff_ratio(0x920A, 50, 1), tiff_text(0xA433, "Own"),
                                 tiff_text(0xA434, "Own 50mm f/2")};  // FNumber, FocalLength, LensMake, LensModel
};

/// 36 mm wide: its pixels a centimetre.
inline const TiffEntry kPixelsACentimetre = tiff_ratio(0xA20E, 60000, 36);
inline const TiffEntry kCentimetre{.tag = 0xA210, .type = 3, .count = 1, .value = little_endian(3, 2)};

inline std::vector<TiffEntry> with_focal_plane(std::vector<TiffEntry> photo) {
    photo.insert(std::find_if(photo.begin(), photo.end(), [](const TiffEntry& e) { return e.tag > 0xA20E; }),
                 {kPixelsACentimetre, kCentimetre});
    return photo;
}

/// A first directory as of a preview, the raw picture's and the EXIF's below it.
inline std::string dng_bytes(const Dng& dng) {
    const TiffEntry version{.tag = 0xC612, .type = 1, .count = 4, .value = std::string("\x01\x04\x00\x00", 4)};
    const auto first = [&](std::size_t raw, std::size_t photo) {
        return directory(8, {tiff_long(0x0106, 2), tiff_long(0x014A, static_cast<std::uint32_t>(raw)),
                             tiff_long(0x8769, static_cast<std::uint32_t>(photo)), version});
    };
    const std::size_t raw_at = 8 + first(0, 0).size();
    std::vector<TiffEntry> raw_entries{tiff_long(0x00FE, 0), tiff_long(0x0100, dng.width),
                                       tiff_long(0x0101, dng.height), tiff_long(0x0106, 32803)};
    if (!dng.opcodes.empty()) {
        raw_entries.push_back(tiff_bytes(0xC74E, dng.opcodes));
    }
    const std::string raw = directory(raw_at, raw_entries);
    const std::size_t photo_at = raw_at + raw.size();
    return std::string("II*\0", 4) + little_endian(8, 4) + first(raw_at, photo_at) + raw +
           directory(photo_at, dng.photo);
}

}  // namespace lensproof::calibration::synthetic
