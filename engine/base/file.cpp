#include "engine/base/file.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include "engine/base/input_error.h"
#include "engine/base/text.h"

namespace lensproof {

namespace fs = std::filesystem;

namespace {

// No text, table or photo comes near; /dev/zero would go on for ever.
constexpr std::size_t kLargestFile = std::size_t{256} << 20;
constexpr std::size_t kChunk = std::size_t{1} << 20;

}  // namespace

void check_readable(const fs::path& file) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status)) {
        throw InputError(fmt::format("{}: no such file", file.string()));
    }
    if (fs::is_directory(status)) {
        throw InputError(fmt::format("{}: is a folder, expected a file", file.string()));
    }
}

std::string read_file(const fs::path& file) {
    check_readable(file);
    std::ifstream stream(file, std::ios::binary);
    std::string content;
    while (stream.good()) {
        const std::size_t before = content.size();
        if (before > kLargestFile) {
            throw InputError(fmt::format("{}: is larger than 256 MiB, expected a smaller file", file.string()));
        }
        content.resize(before + kChunk);
        stream.read(content.data() + before, static_cast<std::streamsize>(kChunk));
        content.resize(before + static_cast<std::size_t>(stream.gcount()));
    }
    if (!stream.eof()) {
        throw InputError(fmt::format("{}: cannot be read", file.string()));
    }
    return content;
}

std::string lower_extension(const fs::path& file) {
    return lower_case(file.extension().string());
}

fs::path data_root() {
    const char* home = std::getenv("LENSPROOF_HOME");
    return home != nullptr && *home != '\0' ? fs::path(home) : fs::path(LENSPROOF_SOURCE_DIR);
}

}  // namespace lensproof
