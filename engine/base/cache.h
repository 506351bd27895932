// engine/base/cache.h — derived data kept on disk between runs, and never trusted.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace lensproof {

/// Remembers what takes long to compute, by everything that it follows from. A cache never fails: what cannot be read
/// or is not what was asked for is computed again, and what cannot be written is not kept.
///
/// A file is named by a hash of its key and holds the whole key, the payload and a checksum of both. It answers only
/// where the key is the same byte by byte and the checksum holds, so neither another key with that hash, nor a file of
/// another version, nor a damaged one does. Files appear whole or not at all; any number of processes may share a
/// folder.
class Cache {
  public:
    /// Keeps nothing.
    Cache() = default;

    /// Keeps its files in `folder`, which is made on demand; at most `limit_bytes` of them, those used last.
    explicit Cache(std::filesystem::path folder, std::uintmax_t limit_bytes = std::uintmax_t{256} << 20U);

    /// The user's: the folder $LENSPROOF_CACHE, where that is set (empty or "off": keeps nothing); else lensproof in
    /// $XDG_CACHE_HOME, else in $HOME/.cache (absolute ones, as the XDG base directory specification has it); else
    /// keeps nothing.
    static Cache standard();

    /// What was stored under this key, or nothing. `kind` says what it is, in a word of letters and hyphens that begins
    /// the file's name. `key` is everything that the payload follows from, the algorithm's version included: the
    /// numbers themselves, as bytes.
    [[nodiscard]] std::optional<std::string> find(std::string_view kind, std::string_view key) const;

    void store(std::string_view kind, std::string_view key, std::string_view payload) const;

    /// Where this key's payload lies, or would.
    [[nodiscard]] std::filesystem::path file(std::string_view kind, std::string_view key) const;

  private:
    [[nodiscard]] std::optional<std::string> checked_payload(std::string_view kind, std::string_view key) const;
    void make_room() const;

    std::filesystem::path folder_;  // empty: keeps nothing
    std::uintmax_t limit_bytes_ = 0;
};

/// What make() makes: from the cache where that has it, else made, and kept. `Kept` has serialized() and
/// deserialized(bytes), which gives nothing for what is none.
template <class Kept, class Make>
Kept kept(const Cache& cache, std::string_view kind, std::string_view key, const Make& make) {
    if (const std::optional<std::string> bytes = cache.find(kind, key)) {
        if (std::optional<Kept> found = Kept::deserialized(*bytes)) {
            return *std::move(found);
        }
    }
    Kept made = make();
    cache.store(kind, key, made.serialized());
    return made;
}

}  // namespace lensproof
