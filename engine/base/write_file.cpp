#include "engine/base/write_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <mutex>
#include <random>
#include <set>
#include <string>
#include <system_error>

#include "engine/base/input_error.h"

namespace lensproof {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kTemporaryStart = ".lensproof-";
constexpr std::size_t kTemporaryDigits = 16;
constexpr std::string_view kTemporaryMark = ".part";
constexpr std::size_t kLongestExtension = 16;  // a longer one is no format's

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// `folder`, or the nearest above it that is there.
fs::path nearest_there(fs::path folder) {
    std::error_code error;
    while (!folder.empty() && folder != folder.parent_path() && !fs::exists(folder, error)) {
        folder = folder.parent_path();
    }
    return folder.empty() ? fs::path(".") : folder;
}

std::system_error system_failure(int code, const fs::path& file) {
    return {code, std::generic_category(), file.string() + " cannot be written"};
}

/// Waits until what was written to a file or a folder is on the disk, for the sake of `file`.
void sync(const fs::path& path, const fs::path& file) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool is_synced = descriptor != -1 && ::fsync(descriptor) == 0;
    const int failure = errno;
    if (descriptor != -1) {
        ::close(descriptor);
    }
    if (!is_synced && failure != EINVAL && failure != EACCES) {  // a file system, or a folder's owner, that will not
        throw system_failure(failure, file);
    }
}

/// A new, empty file in a folder, with the extension of the `file` that it stands for, gone with this object. It is
/// locked as long as its process lives, on whatever machine: so the next one knows what was left behind.
class TemporaryFile {
  public:
    TemporaryFile(const fs::path& folder, const fs::path& file) {
        std::random_device random;
        struct stat status {};
        do {
            const std::string extension = file.extension().string();
            path_ = folder / fmt::format("{}{:08x}{:08x}{}{}", kTemporaryStart, random(), random(), kTemporaryMark,
                                         extension.size() <= kLongestExtension ? extension : "");
            close();
            descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
            if (descriptor_ == -1 && errno != EEXIST) {
                throw system_failure(errno, file);
            }
            // Another process may have taken it for a leftover before it was locked.
        } while (descriptor_ == -1 || (::flock(descriptor_, LOCK_EX | LOCK_NB) == -1 && errno == EWOULDBLOCK) ||
                 (::fstat(descriptor_, &status) == 0 && status.st_nlink == 0));
    }
    ~TemporaryFile() {
        std::error_code ignored;
        if (!is_renamed_) {
            fs::remove(path_, ignored);
        }
        close();
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    [[nodiscard]] const fs::path& path() const { return path_; }

    void rename(const fs::path& target, const fs::path& file) {
        if (::rename(path_.c_str(), target.c_str()) != 0) {
            throw system_failure(errno, file);
        }
        is_renamed_ = true;
    }

  private:
    void close() {
        if (descriptor_ != -1) {
            ::close(descriptor_);
            descriptor_ = -1;
        }
    }

    fs::path path_;
    int descriptor_ = -1;
    bool is_renamed_ = false;
};

/// Whether TemporaryFile makes such names.
bool is_temporary_name(std::string_view name) {
    if (!name.starts_with(kTemporaryStart)) {
        return false;
    }
    name.remove_prefix(kTemporaryStart.size());
    const std::size_t digits = std::min(name.find_first_not_of("0123456789abcdef"), name.size());
    const std::string_view rest = name.substr(digits);
    return digits == kTemporaryDigits && rest.starts_with(kTemporaryMark) &&
           (rest == kTemporaryMark || rest[kTemporaryMark.size()] == '.');
}

/// Removes what killed processes left in a folder: temporary files that nobody has locked.
void remove_leftovers(const fs::path& folder) {
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (!is_temporary_name(name) || !entry.is_regular_file(error)) {
            continue;
        }
        const int descriptor = ::open(entry.path().c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
        if (descriptor == -1) {
            continue;
        }
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
            fs::remove(entry.path(), error);
        }
        ::close(descriptor);
    }
}

void remove_leftovers_once(const fs::path& folder) {
    static std::mutex mutex;
    static std::set<fs::path> seen;
    std::error_code error;
    const std::scoped_lock lock(mutex);
    if (seen.insert(fs::absolute(folder, error)).second) {
        remove_leftovers(folder);
    }
}

/// What a rename to `file` has to replace: a link's target.
fs::path replaced_by(const fs::path& file) {
    std::error_code error;
    return fs::is_symlink(file, error) && fs::exists(file, error) ? fs::canonical(file) : file;
}

[[noreturn]] void refuse(const fs::path& file, const fs::path& place, int code) {
    throw InputError(fmt::format("{}: {} may not be written to ({}), expected a place that may", file.string(),
                                 place.string(), std::generic_category().message(code)));
}

/// Makes the folders that are missing above `file`, and waits until they are on the disk.
void make_folders(const fs::path& file, Durability durability) {
    const fs::path there = nearest_there(folder_of(file));
    fs::create_directories(folder_of(file));
    for (fs::path made = folder_of(file);
         durability == Durability::power_cut && made != there && made.has_parent_path(); made = made.parent_path()) {
        sync(folder_of(made), file);
    }
}

/// What can be wrong with a name as such.
void check_name(const fs::path& file) {
    std::error_code error;
    if (!file.has_filename() || fs::is_directory(file, error)) {
        throw InputError(fmt::format("{}: is a folder, expected a file name to write", file.string()));
    }
    const fs::path folder = nearest_there(file.parent_path());
    if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
        throw InputError(
            fmt::format("{}: {} is a file, expected a folder to write into", file.string(), folder.string()));
    }
    const long longest = ::pathconf(folder.c_str(), _PC_NAME_MAX);
    for (const fs::path& name : file) {
        if (longest > 0 && name.native().size() > static_cast<std::size_t>(longest)) {
            throw InputError(fmt::format("{}: a name of {} bytes, expected at most {}", file.string(),
                                         name.native().size(), longest));
        }
    }
    // The temporary file's name takes the place of the last.
    constexpr std::size_t kTemporaryName =
        kTemporaryStart.size() + kTemporaryDigits + kTemporaryMark.size() + kLongestExtension;
    const std::size_t path = std::max(file.native().size(), file.parent_path().native().size() + 1 + kTemporaryName);
    if (path >= PATH_MAX) {
        throw InputError(fmt::format("{}: a path of {} bytes, expected at most {}", file.string(), file.native().size(),
                                     PATH_MAX - 1 - (path - file.native().size())));
    }
}

}  // namespace

void check_output_name(const fs::path& file) {
    check_name(file);
    std::error_code error;
    if (fs::exists(file, error) && !fs::is_regular_file(file, error)) {
        if (::access(file.c_str(), W_OK) != 0) {
            refuse(file, file, errno);
        }
        return;
    }
    const fs::path place = nearest_there(folder_of(replaced_by(file)));
    try {
        const TemporaryFile trial(place, file);  // permission bits do not tell all
    } catch (const std::system_error& failure) {
        const int code = failure.code().value();
        if (code == EACCES || code == EPERM || code == EROFS || code == ENOENT) {
            refuse(file, place, code);
        }
        throw;
    }
}

void write_whole(const fs::path& named, const std::function<void(const fs::path&)>& write, Durability durability) {
    check_name(named);
    std::error_code error;
    if (fs::exists(named, error) && !fs::is_regular_file(named, error)) {
        write(named);  // a rename would put a file in the place of /dev/null
        return;
    }
    const fs::path file = replaced_by(named);
    make_folders(file, durability);
    remove_leftovers_once(folder_of(file));
    TemporaryFile temporary(folder_of(file), named);
    write(temporary.path());
    if (durability == Durability::power_cut) {
        sync(temporary.path(), named);
    }
    temporary.rename(file, named);
    if (durability == Durability::power_cut) {
        sync(folder_of(file), named);
    }
}

void write_stream(const fs::path& file, const std::function<void(std::ostream&)>& write, Durability durability) {
    write_whole(
        file,
        [&](const fs::path& temporary) {
            errno = 0;
            std::ofstream stream(temporary, std::ios::binary);
            write(stream);
            stream.close();
            if (!stream) {
                throw system_failure(errno != 0 ? errno : EIO, file);
            }
        },
        durability);
}

void write_file(const fs::path& file, std::string_view content, Durability durability) {
    write_stream(
        file, [&](std::ostream& stream) { stream.write(content.data(), static_cast<std::streamsize>(content.size())); },
        durability);
}

Delivery write_somewhere(const std::vector<fs::path>& places, const std::function<void(const fs::path&)>& write) {
    std::exception_ptr first;
    std::string complaint;
    const auto takes = [&](const fs::path& place) {
        try {
            write(place);
            return true;
        } catch (const std::exception& failure) {
            if (!first) {
                first = std::current_exception();
                complaint = failure.what();
            }
            return false;
        }
    };
    std::error_code error;
    for (const fs::path& place : places) {
        if ((!first || !fs::exists(place, error)) && takes(place)) {
            return {place, complaint};
        }
    }
    std::string folder = (fs::temp_directory_path(error) / "lensproof-XXXXXX").string();
    if (!error && ::mkdtemp(folder.data()) != nullptr) {
        if (const fs::path last = folder / places.front().filename(); takes(last)) {
            return {last, complaint};
        }
        fs::remove_all(folder, error);
    }
    std::rethrow_exception(first);
}

}  // namespace lensproof
