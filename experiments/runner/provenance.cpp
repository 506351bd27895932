#include "experiments/runner/provenance.h"

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <sstream>

// libmd's header has no C++ guard of its own on every release.
extern "C" {
#include <sha2.h>
}

#include "engine/base/data_root.h"
#include "engine/base/file.h"

namespace lensproof::runner {

namespace fs = std::filesystem;

namespace {

std::string first_line(const fs::path& file) {
    std::istringstream content(read_file(file));
    std::string line;
    std::getline(content, line);
    return line;
}

/// Where git keeps what is this checkout's own: in `place`, or where that, of a worktree, says.
fs::path git_folder(const fs::path& place) {
    const std::string prefix = "gitdir: ";
    const std::string line = fs::is_regular_file(place) ? first_line(place) : "";
    return line.starts_with(prefix) ? place.parent_path() / line.substr(prefix.size()) : place;
}

/// The commit that `reference` ("refs/heads/main") names in .git/packed-refs.
std::string packed_reference(const fs::path& git, const std::string& reference) {
    if (!fs::exists(git / "packed-refs")) {
        return "unknown";
    }
    std::istringstream content(read_file(git / "packed-refs"));
    for (std::string commit, name; content >> commit && std::getline(content >> std::ws, name);) {
        if (name == reference) {
            return commit;
        }
    }
    return "unknown";
}

}  // namespace

std::string program_version() {
    return LENSPROOF_VERSION;
}

std::string compiler_version() {
    return LENSPROOF_COMPILER;
}

std::string library_versions() {
    return LENSPROOF_LIBRARIES;
}

std::string sha256(const fs::path& file) {
    const std::string content = read_file(file);
    std::array<char, SHA256_DIGEST_STRING_LENGTH> digest{};
    SHA256Data(reinterpret_cast<const std::uint8_t*>(content.data()), content.size(), digest.data());
    return digest.data();
}

std::string source_commit() {
    const fs::path git = git_folder(data_root() / ".git");
    if (!fs::exists(git / "HEAD")) {
        return fs::exists(data_root() / "commit") ? first_line(data_root() / "commit") : "unknown";
    }
    std::string head = first_line(git / "HEAD");
    const std::string prefix = "ref: ";
    if (head.rfind(prefix, 0) != 0) {
        return head;
    }
    const std::string reference = head.substr(prefix.size());
    const fs::path shared = fs::exists(git / "commondir") ? git / first_line(git / "commondir") : git;
    return fs::exists(shared / reference) ? first_line(shared / reference) : packed_reference(shared, reference);
}

std::string portable_path(const fs::path& file) {
    const fs::path relative = fs::weakly_canonical(file).lexically_relative(fs::weakly_canonical(data_root()));
    const bool inside = !relative.empty() && *relative.begin() != "..";
    return inside ? relative.string() : file.lexically_normal().string();
}

}  // namespace lensproof::runner
