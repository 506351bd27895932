#include "engine/base/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <fstream>
#include <system_error>

#include "engine/base/confined.h"
#include "engine/base/data_root.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"

namespace lensproof {

namespace fs = std::filesystem;

namespace {

// No text, table or photo comes near; /dev/zero would go on for ever.
constexpr std::size_t kLargestFile = std::size_t{256} << 20;

/// Links followed, as far as there are such files.
fs::path place_of(const fs::path& file) {
    std::error_code error;
    const fs::path place = fs::weakly_canonical(fs::absolute(file), error);
    return error ? fs::path() : place;
}

bool lies_in(const fs::path& folder, const fs::path& file) {
    const fs::path within = file.lexically_relative(folder);
    return !within.empty() && *within.begin() != "..";
}

}  // namespace

bool is_there(const fs::path& file) {
    std::error_code error;
    return fs::exists(file, error);
}

bool is_folder(const fs::path& file) {
    std::error_code error;
    return fs::is_directory(file, error);
}

void check_readable(const fs::path& file) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status)) {
        throw InputError(fmt::format("{}: no such file", file.string()));
    }
    if (fs::is_directory(status)) {
        throw InputError(fmt::format("{}: is a folder, expected a file", file.string()));
    }
    if (fs::is_socket(status) || fs::is_block_file(status)) {
        throw InputError(fmt::format("{}: is a {}, expected a file", file.string(),
                                     fs::is_socket(status) ? "socket" : "block device"));
    }
}

void check_regular(const fs::path& file, std::string_view expected) {
    check_readable(file);
    if (!fs::is_regular_file(file)) {
        throw InputError(fmt::format("{}: is a device or a pipe, expected {}", file.string(), expected));
    }
}

std::string read_file(const fs::path& file) {
    check_readable(file);
    // Not blocking: a pipe that nobody writes to then has its end at once, and one whose writer is slow says so.
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    std::string content;
    std::array<char, std::size_t{64} << 10> chunk{};
    ssize_t count = descriptor == -1 ? -1 : 1;
    while (count > 0) {
        if (content.size() > kLargestFile) {
            ::close(descriptor);
            throw InputError(fmt::format("{}: is larger than 256 MiB, expected a smaller file", file.string()));
        }
        while ((count = ::read(descriptor, chunk.data(), chunk.size())) == -1 && (errno == EAGAIN || errno == EINTR)) {
            pollfd more{.fd = descriptor, .events = POLLIN, .revents = 0};
            ::poll(&more, 1, -1);
        }
        content.append(chunk.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    }
    if (descriptor != -1) {
        ::close(descriptor);
    }
    if (count == -1) {
        throw InputError(fmt::format("{}: cannot be read", file.string()));
    }
    std::error_code error;
    if (content.empty() && fs::is_fifo(file, error)) {
        throw InputError(fmt::format("{}: is a pipe that nothing is written to, expected a file", file.string()));
    }
    return content;
}

void check_reference(const fs::path& from, const fs::path& file) {
    if (!files_are_distrusted()) {
        return;
    }
    const fs::path place = place_of(file);
    if (!lies_in(place_of(from).parent_path(), place) && !lies_in(place_of(data_root()), place)) {
        throw InputError(fmt::format("{}: refers to {}, expected a file in its own folder, as --untrusted asks",
                                     from.string(), file.string()));
    }
}

fs::path referred_file(const fs::path& from, const fs::path& name) {
    fs::path file = from.parent_path() / name;
    check_reference(from, file);
    return file;
}

std::string lower_extension(const fs::path& file) {
    return lower_case(file.extension().string());
}

}  // namespace lensproof
