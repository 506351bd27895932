// experiments/python/exr_parts.h — the parts of an EXR file as they are in it, number by number.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lensproof::python {

/// What a part says of itself.
struct ExrPart {
    std::string name;
    std::vector<std::string> channels;
    int width = 0;
    int height = 0;
    bool is_whole = false;  // its numbers are unsigned integers, of 32 bits; else floats of 32 bits
    std::map<std::string, std::string> attributes;  // that are text
};

/// Throws InputError, as what follows, for a file that is no EXR, or is damaged.
std::vector<ExrPart> exr_parts(const std::filesystem::path& file);

/// The numbers of the part, from 0: row by row, and of a pixel channel by channel; width × height × channels of them.
void read_exr_part(const std::filesystem::path& file, int part, std::uint32_t* numbers, std::size_t count);

}  // namespace lensproof::python
