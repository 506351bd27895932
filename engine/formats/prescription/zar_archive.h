// engine/formats/prescription/zar_archive.h — Zemax's archives: files one behind the other, each packed by itself.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lensproof::formats {

/// A file in an archive, still packed.
struct ZarMember {
    std::string name;  // without the ending .LZW
    std::string_view packed;
    bool is_lzw = false;
};

/// A ZAR is a series of records: a header of 0x288 bytes that begins with EC (in older versions of 0x14C bytes, with
/// EA), the size of what follows at 0x10 (8 bytes, little endian; older: 4 bytes at 0xC), the file's name at 0x30 in
/// UTF-16 (older: at 0x20 in 8 bits), each to a zero; then the file, packed where its name ends in .LZW. As the program
/// zmxtools (Van Vaerenbergh 2021) has found. `bytes` has to outlive the result. Throws InputError naming the byte
/// where there is no such record, and for more than 1000 of them.
std::vector<ZarMember> zar_members(std::string_view bytes, const std::filesystem::path& file);

/// What is in it, up to 16 MiB; a longer one, or what is no LZW, is an InputError.
///
/// LZW (Welch 1984): codes of 9 bits, most significant first, and one more bit each time that the table of words, which
/// starts with the 256 bytes, has grown to the next power of two; there is no code that clears it.
std::string unpacked(const ZarMember& member, const std::filesystem::path& file);

}  // namespace lensproof::formats
