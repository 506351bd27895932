#include "engine/base/cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/base/bytes.h"
#include "engine/base/file.h"
#include "engine/base/hash.h"
#include "engine/base/write_file.h"

namespace lensproof {

namespace fs = std::filesystem;

namespace {

// The file's form. A number, not its digits: a machine of another byte order takes it for another version.
constexpr std::uint32_t kVersion = 1;
constexpr std::string_view kExtension = ".cache";

/// What stands in front of the payload. No length is ever read from a file: this is compared as a whole.
std::string header(std::string_view kind, std::string_view key) {
    std::string bytes = "lensproof cache\n";
    append_bytes(bytes, kVersion);
    for (const std::string_view part : {kind, key}) {
        append_bytes(bytes, static_cast<std::uint64_t>(part.size()));
        bytes += part;
    }
    return bytes;
}

std::string checksum(std::string_view bytes) {
    std::string sum;
    append_bytes(sum, hash_of(bytes));
    return sum;
}

/// The variable's value as a path; nothing where it is not set.
std::optional<fs::path> path_from_environment(const char* variable) {
    const char* value = std::getenv(variable);
    return value != nullptr ? std::optional<fs::path>(value) : std::nullopt;
}

}  // namespace

Cache::Cache(fs::path folder, std::uintmax_t limit_bytes) : folder_(std::move(folder)), limit_bytes_(limit_bytes) {}

Cache Cache::standard() {
    if (const auto own = path_from_environment("LENSPROOF_CACHE")) {
        return own->empty() || *own == "off" ? Cache() : Cache(*own);
    }
    if (const auto caches = path_from_environment("XDG_CACHE_HOME"); caches && caches->is_absolute()) {
        return Cache(*caches / "lensproof");
    }
    if (const auto home = path_from_environment("HOME"); home && home->is_absolute()) {
        return Cache(*home / ".cache" / "lensproof");
    }
    return {};
}

fs::path Cache::file(std::string_view kind, std::string_view key) const {
    return folder_ / fmt::format("{}-{:016x}{}", kind, hash_of(key), kExtension);
}

std::optional<std::string> Cache::checked_payload(std::string_view kind, std::string_view key) const {
    const fs::path kept = file(kind, key);
    if (!fs::is_regular_file(kept)) {  // a pipe would wait for ever
        return std::nullopt;
    }
    std::string content = read_file(kept);
    const std::string expected = header(kind, key);
    const std::size_t around = expected.size() + checksum({}).size();
    if (content.size() < around || !content.starts_with(expected)) {
        return std::nullopt;
    }
    const std::size_t end = content.size() - checksum({}).size();
    const std::string_view summed = std::string_view(content).substr(0, end);
    if (!content.ends_with(checksum(summed))) {
        return std::nullopt;
    }
    std::error_code ignored;
    fs::last_write_time(kept, fs::file_time_type::clock::now(), ignored);  // used last: kept longest
    return content.substr(expected.size(), content.size() - around);
}

std::optional<std::string> Cache::find(std::string_view kind, std::string_view key) const {
    if (folder_.empty()) {
        return std::nullopt;
    }
    try {
        return checked_payload(kind, key);
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

void Cache::store(std::string_view kind, std::string_view key, std::string_view payload) const {
    if (folder_.empty()) {
        return;
    }
    try {
        std::string content = header(kind, key);
        content += payload;
        content += checksum(content);
        const fs::path kept = file(kind, key);
        if (content.size() <= limit_bytes_ && (!fs::exists(kept) || fs::is_regular_file(kept))) {
            write_file(kept, content, Durability::usual);
            make_room();
        }
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): not kept, as promised
    }
}

void Cache::make_room() const {
    struct Kept {
        fs::file_time_type used;
        std::uintmax_t bytes;
        fs::path path;
    };
    std::vector<Kept> files;
    std::uintmax_t total = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
        std::error_code no_size;  // another process makes room too
        std::error_code no_time;
        const std::uintmax_t bytes = entry.file_size(no_size);
        const fs::file_time_type used = entry.last_write_time(no_time);
        if (entry.path().extension() == kExtension && !no_size && !no_time) {
            files.push_back({used, bytes, entry.path()});
            total += bytes;
        }
    }
    std::ranges::sort(files, {}, &Kept::used);
    for (const Kept& oldest : files) {
        if (total <= limit_bytes_) {
            break;
        }
        std::error_code gone;
        fs::remove(oldest.path, gone);
        total -= oldest.bytes;
    }
}

}  // namespace lensproof
