#include "engine/render/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>

#include "engine/base/bytes.h"
#include "engine/base/file.h"
#include "engine/base/hash.h"
#include "engine/base/input_error.h"
#include "engine/base/write_file.h"

namespace lensproof::render {

namespace fs = std::filesystem;

namespace {

// The file's form. A number, not its digits: a machine of another byte order takes it for another version.
constexpr std::uint32_t kVersion = 3;
constexpr std::string_view kMagic = "lensproof checkpoint\n";
constexpr std::size_t kPiece = std::size_t{1} << 20U;
constexpr std::size_t kDigestSize = sizeof(std::uint64_t);

/// Writes bytes and at the end a digest of them, piece by piece: films are large.
class DigestedWriter {
  public:
    explicit DigestedWriter(const fs::path& file) : stream_(file, std::ios::binary) { piece_.reserve(kPiece); }

    void write(std::string_view bytes) {
        while (!bytes.empty()) {
            const std::size_t count = std::min(bytes.size(), kPiece - piece_.size());
            piece_.append(bytes.substr(0, count));
            bytes.remove_prefix(count);
            if (piece_.size() == kPiece) {
                flush();
            }
        }
    }

    template <class... Numbers>
    void write_numbers(const Numbers&... numbers) {
        std::string bytes;
        append_bytes(bytes, numbers...);
        write(bytes);
    }

    template <class Number>
    void write_all(const std::vector<Number>& numbers) {
        write({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)});
    }

    /// Returns whether all went well.
    bool finish() {
        flush();
        std::string digest;
        append_bytes(digest, digest_);
        stream_.write(digest.data(), static_cast<std::streamsize>(digest.size()));
        stream_.close();
        return static_cast<bool>(stream_);
    }

  private:
    void flush() {
        digest_ = hash_of(piece_, digest_);
        stream_.write(piece_.data(), static_cast<std::streamsize>(piece_.size()));
        piece_.clear();
    }

    std::ofstream stream_;
    std::string piece_;
    std::uint64_t digest_ = 0;
};

/// Reads what the above wrote, after it has compared the digest of all of it.
class DigestedReader {
  public:
    explicit DigestedReader(const fs::path& file) : file_(file) {
        check_regular(file, "a checkpoint");
        left_ = fs::file_size(file);
        stream_.open(file, std::ios::binary);
        if (std::string magic(kMagic.size(), '\0');
            left_ < kMagic.size() + kDigestSize || !stream_.read(magic.data(), kMagic.size()) || magic != kMagic) {
            throw InputError(fmt::format("{}: is not a checkpoint of lensproof; another --checkpoint leaves it alone",
                                         file.string()));
        }
        left_ -= kDigestSize;
        check_digest();
        stream_.seekg(kMagic.size());
        left_ -= kMagic.size();
    }

    [[noreturn]] void fail() const {
        throw InputError(fmt::format("{}: the checkpoint is damaged; remove it to begin anew", file_.string()));
    }

    template <class Number>
    Number number() {
        Number value{};
        read(&value, sizeof value);
        return value;
    }

    std::string text() {
        const auto size = number<std::uint64_t>();
        if (size > left_) {
            fail();
        }
        std::string bytes(size, '\0');
        read(bytes.data(), size);
        return bytes;
    }

    template <class Number>
    void read_all(std::vector<Number>& numbers) {
        read(numbers.data(), numbers.size() * sizeof(Number));
    }

    void expect_left(std::uintmax_t bytes) const {
        if (left_ != bytes) {
            fail();
        }
    }

  private:
    void read(void* to, std::uintmax_t bytes) {
        if (bytes > left_ || !stream_.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes))) {
            fail();
        }
        left_ -= bytes;
    }

    void check_digest() {
        stream_.seekg(0);
        std::string piece;
        std::uint64_t digest = 0;
        for (std::uintmax_t rest = left_; rest > 0; rest -= piece.size()) {
            piece.resize(std::min<std::uintmax_t>(rest, kPiece));
            if (!stream_.read(piece.data(), static_cast<std::streamsize>(piece.size()))) {
                fail();
            }
            digest = hash_of(piece, digest);
        }
        std::uint64_t expected = 0;
        if (!stream_.read(reinterpret_cast<char*>(&expected), sizeof expected) || digest != expected) {
            fail();
        }
    }

    fs::path file_;
    std::ifstream stream_;
    std::uintmax_t left_ = 0;
};

/// What a film's sums are shaped by.
std::string shape_of(const RenderState& state) {
    const FilmLayout& layout = state.film.layout();
    std::string bytes;
    append_bytes(bytes, layout.width, layout.height, layout.has_splats, layout.has_features, layout.layer_nm.size(),
                 layout.rgb_weights.size(), state.tiles.size());
    return bytes + state.pass;
}

void write_text(DigestedWriter& writer, std::string_view text) {
    writer.write_numbers(static_cast<std::uint64_t>(text.size()));
    writer.write(text);
}

void write_progress(DigestedWriter& writer, const RenderState& state) {
    write_text(writer, shape_of(state));
    writer.write_numbers(state.range.first, state.range.end);
    for (const TileProgress& tile : state.tiles) {
        writer.write_numbers(tile.done, tile.target);
    }
}

void write_sums(DigestedWriter& writer, const RenderState& state) {
    Film::visit_sums(state.film, [&]<class Sums>(const Sums& sums) {
        if constexpr (std::is_arithmetic_v<Sums>) {
            writer.write_numbers(sums);
        } else {
            writer.write_all(sums);
        }
    });
}

void write_render(DigestedWriter& writer, const RenderIdentity& identity, std::span<const RenderState> passes) {
    writer.write(kMagic);
    writer.write_numbers(kVersion, static_cast<std::uint64_t>(identity.size()));
    for (const IdentityPart& part : identity) {
        write_text(writer, part.name);
        write_text(writer, part.value);
    }
    writer.write_numbers(static_cast<std::uint64_t>(passes.size()));
    for (const RenderState& state : passes) {
        write_progress(writer, state);
    }
    for (const RenderState& state : passes) {
        write_sums(writer, state);
    }
}

std::uintmax_t bytes_of_sums(const Film& film) {
    std::uintmax_t bytes = 0;
    Film::visit_sums(film, [&]<class Sums>(const Sums& sums) {
        if constexpr (std::is_arithmetic_v<Sums>) {
            bytes += sizeof sums;
        } else {
            bytes += sums.size() * sizeof sums[0];
        }
    });
    return bytes;
}

InputError of_another_render(const fs::path& file, const std::string& why) {
    return InputError(
        fmt::format("{}: the checkpoint is of another render: {}; remove it to begin anew", file.string(), why));
}

RenderIdentity read_identity(DigestedReader& reader) {
    RenderIdentity identity;
    for (auto parts = reader.number<std::uint64_t>(); parts > 0; --parts) {
        std::string name = reader.text();
        identity.push_back({std::move(name), reader.text()});
    }
    return identity;
}

/// A film's shape, its range and how far its tiles are.
std::vector<TileProgress> read_tiles(DigestedReader& reader, const fs::path& file, const RenderState& state) {
    if (reader.text() != shape_of(state)) {
        throw of_another_render(file, "its film has another size or other layers");
    }
    const auto first = reader.number<std::uint32_t>();
    reader.number<std::uint32_t>();
    if (first != state.range.first) {
        throw of_another_render(file, fmt::format("its samples begin at {}, expected {}", first, state.range.first));
    }
    std::vector<TileProgress> tiles(state.tiles.size());
    for (TileProgress& tile : tiles) {
        tile.done = reader.number<std::uint32_t>();
        tile.target = std::min(reader.number<std::uint32_t>(), state.range.end);
        if (tile.done > state.range.end) {
            throw InputError(fmt::format("{}: the checkpoint has {} samples a pixel already, expected {} at most",
                                         file.string(), tile.done - first, state.range.end - first));
        }
        if (tile.done < first || tile.target < tile.done) {
            reader.fail();
        }
    }
    return tiles;
}

void read_sums(DigestedReader& reader, Film& film) {
    Film::visit_sums(film, [&]<class Sums>(Sums& sums) {
        if constexpr (std::is_arithmetic_v<Sums>) {
            sums = reader.number<Sums>();
        } else {
            reader.read_all(sums);
        }
    });
}

}  // namespace

void write_checkpoint(const fs::path& file, const RenderIdentity& identity, std::span<const RenderState> passes) {
    write_whole(file, [&](const fs::path& temporary) {
        errno = 0;
        DigestedWriter writer(temporary);
        write_render(writer, identity, passes);
        if (!writer.finish()) {
            throw std::system_error(errno != 0 ? errno : EIO, std::generic_category(),
                                    file.string() + " cannot be written");
        }
    });
}

void read_checkpoint(const fs::path& file, const RenderIdentity& identity, std::span<RenderState> passes) {
    DigestedReader reader(file);
    if (const auto version = reader.number<std::uint32_t>(); version != kVersion) {
        throw of_another_render(file, fmt::format("its form is version {}, expected {}", version, kVersion));
    }
    if (const auto difference = first_difference(read_identity(reader), identity)) {
        throw of_another_render(file, *difference);
    }
    if (const auto count = reader.number<std::uint64_t>(); count != passes.size()) {
        throw of_another_render(file, fmt::format("it has {} passes, expected {}", count, passes.size()));
    }
    std::vector<std::vector<TileProgress>> tiles;
    std::uintmax_t bytes = 0;
    for (const RenderState& state : passes) {
        tiles.push_back(read_tiles(reader, file, state));
        bytes += bytes_of_sums(state.film);
    }
    reader.expect_left(bytes);
    for (std::size_t i = 0; i < passes.size(); ++i) {
        passes[i].tiles = std::move(tiles[i]);
        read_sums(reader, passes[i].film);
    }
}

}  // namespace lensproof::render
