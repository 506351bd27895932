#include "engine/io/file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <system_error>

#include "engine/io/input_error.h"

namespace lensproof {

namespace fs = std::filesystem;

std::string read_file(const fs::path& file) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status)) {
        throw InputError(fmt::format("{}: no such file", file.string()));
    }
    if (fs::is_directory(status)) {
        throw InputError(fmt::format("{}: is a folder, expected a file", file.string()));
    }
    std::ifstream stream(file, std::ios::binary);
    std::string content{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (!stream) {
        throw InputError(fmt::format("{}: cannot be read", file.string()));
    }
    return content;
}

void write_whole(const fs::path& file, const std::function<void(const fs::path&)>& write) {
    std::error_code error;
    if (fs::is_directory(file, error)) {
        throw InputError(fmt::format("{}: is a folder, expected a file name to write", file.string()));
    }
    if (file.has_parent_path()) {
        fs::create_directories(file.parent_path(), error);
        if (error) {
            throw InputError(fmt::format("{}: the folder cannot be made: {}", file.string(), error.message()));
        }
    }
    // The extension stays last: image libraries choose the format by it.
    fs::path temporary = file;
    temporary.replace_filename(
        fmt::format(".{}.{}.part{}", file.stem().string(), ::getpid(), file.extension().string()));
    try {
        write(temporary);
        fs::rename(temporary, file);
    } catch (...) {
        fs::remove(temporary, error);
        throw;
    }
}

void write_file(const fs::path& file, std::string_view content) {
    write_whole(file, [&](const fs::path& temporary) {
        std::ofstream stream(temporary, std::ios::binary);
        stream.write(content.data(), static_cast<std::streamsize>(content.size()));
        stream.close();
        if (!stream) {
            throw std::system_error(errno, std::generic_category(), file.string() + " cannot be written");
        }
    });
}

fs::path data_root() {
    const char* home = std::getenv("LENSPROOF_HOME");
    return home != nullptr && *home != '\0' ? fs::path(home) : fs::path(LENSPROOF_SOURCE_DIR);
}

}  // namespace lensproof
