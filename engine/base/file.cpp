#include "engine/base/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
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

constexpr std::string_view kTemporaryMark = ".part";

/// The extension stays last: image libraries choose the format by it.
fs::path temporary_name(const fs::path& file, pid_t process) {
    return fs::path(file).replace_filename(
        fmt::format(".{}.{}{}{}", file.stem().string(), process, kTemporaryMark, file.extension().string()));
}

/// Waits until what was written to a file or a folder is on the disk.
void sync(const fs::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool is_synced = descriptor != -1 && ::fsync(descriptor) == 0;
    const int failure = errno;
    if (descriptor != -1) {
        ::close(descriptor);
    }
    if (!is_synced && failure != EINVAL) {  // a file system that cannot
        throw std::system_error(failure, std::generic_category(), path.string() + " cannot be written");
    }
}

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

void check_output_name(const fs::path& file) {
    std::error_code error;
    if (!file.has_filename() || fs::is_directory(file, error)) {
        throw InputError(fmt::format("{}: is a folder, expected a file name to write", file.string()));
    }
    fs::path folder = file.parent_path();
    while (!folder.empty() && folder != folder.parent_path() && !fs::exists(folder, error)) {
        folder = folder.parent_path();
    }
    if (!folder.empty() && fs::exists(folder, error) && !fs::is_directory(folder, error)) {
        throw InputError(
            fmt::format("{}: {} is a file, expected a folder to write into", file.string(), folder.string()));
    }
}

void write_whole(const fs::path& named, const std::function<void(const fs::path&)>& write, Durability durability) {
    check_output_name(named);
    std::error_code error;
    if (fs::exists(named, error) && !fs::is_regular_file(named, error)) {
        write(named);  // a rename would put a file in the place of /dev/null
        return;
    }
    const fs::path file = fs::is_symlink(named, error) && fs::exists(named, error) ? fs::canonical(named) : named;
    if (file.has_parent_path()) {
        fs::create_directories(file.parent_path());
    }
    const fs::path temporary = temporary_name(file, ::getpid());
    try {
        write(temporary);
        if (durability == Durability::power_cut) {
            sync(temporary);
        }
        fs::rename(temporary, file);
        if (durability == Durability::power_cut) {
            sync(file.has_parent_path() ? file.parent_path() : fs::path("."));
        }
    } catch (...) {
        fs::remove(temporary, error);
        throw;
    }
}

void remove_leftovers(const fs::path& file) {
    std::error_code error;
    const std::string before = fmt::format(".{}.", file.stem().string());
    const std::string after = std::string(kTemporaryMark) + file.extension().string();
    for (const fs::directory_entry& entry :
         fs::directory_iterator(file.has_parent_path() ? file.parent_path() : fs::path("."), error)) {
        const std::string name = entry.path().filename().string();
        if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) {
            continue;
        }
        const std::string number = name.substr(before.size(), name.size() - before.size() - after.size());
        const pid_t process = parse_exact<pid_t>(number).value_or(0);
        if (process > 0 && ::kill(process, 0) == -1 && errno == ESRCH) {
            fs::remove(entry.path(), error);
        }
    }
}

void write_file(const fs::path& file, std::string_view content) {
    write_whole(file, [&](const fs::path& temporary) {
        errno = 0;
        std::ofstream stream(temporary, std::ios::binary);
        stream.write(content.data(), static_cast<std::streamsize>(content.size()));
        stream.close();
        if (!stream) {
            throw std::system_error(errno != 0 ? errno : EIO, std::generic_category(),
                                    file.string() + " cannot be written");
        }
    });
}

std::string lower_extension(const fs::path& file) {
    return lower_case(file.extension().string());
}

fs::path data_root() {
    const char* home = std::getenv("LENSPROOF_HOME");
    return home != nullptr && *home != '\0' ? fs::path(home) : fs::path(LENSPROOF_SOURCE_DIR);
}

}  // namespace lensproof
