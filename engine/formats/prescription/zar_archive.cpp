#include "engine/formats/prescription/zar_archive.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/base/text_encoding.h"

namespace lensproof::formats {

namespace {

constexpr std::size_t kMostMembers = 1000;
constexpr std::size_t kMostBytes = std::size_t{16} << 20U;

/// Where a version's header has what.
struct Layout {
    unsigned char first_byte;
    std::size_t header;
    std::size_t size_at;
    std::size_t size_bytes;
    std::size_t name_at;
    std::size_t letter_bytes;
};
constexpr Layout kLayouts[] = {{0xEC, 0x288, 0x10, 8, 0x30, 2}, {0xEA, 0x14C, 0xC, 4, 0x20, 1}};

std::uint64_t little_endian(std::string_view bytes) {
    std::uint64_t value = 0;
    for (auto byte = bytes.rbegin(); byte != bytes.rend(); ++byte) {
        value = value << 8U | static_cast<unsigned char>(*byte);
    }
    return value;
}

std::string name_in(std::string_view header, const Layout& layout) {
    std::size_t end = layout.name_at;
    while (end + layout.letter_bytes <= header.size() && little_endian(header.substr(end, layout.letter_bytes)) != 0) {
        end += layout.letter_bytes;
    }
    const std::string letters(header.substr(layout.name_at, end - layout.name_at));
    return to_utf8(layout.letter_bytes == 2 ? "\xff\xfe" + letters : letters);
}

/// The words of an LZW stream, each the word `prefix` and a byte more.
class LzwTable {
  public:
    [[nodiscard]] std::size_t size() const { return kBytes + entries_.size(); }

    void add(std::size_t prefix, char last) {
        entries_.push_back({static_cast<std::uint32_t>(prefix), static_cast<std::uint32_t>(length(prefix) + 1), last});
    }

    [[nodiscard]] std::size_t length(std::size_t word) const {
        return word < kBytes ? 1 : entries_[word - kBytes].length;
    }

    /// Writes the word behind `out`, and returns its first byte.
    char append(std::size_t word, std::string& out) const {
        std::size_t at = out.size() + length(word);
        const std::size_t first = out.size();
        out.resize(at);
        for (; word >= kBytes; word = entries_[word - kBytes].prefix) {
            out[--at] = entries_[word - kBytes].last;
        }
        out[first] = static_cast<char>(word);
        return out[first];
    }

  private:
    static constexpr std::size_t kBytes = 256;
    struct Entry {
        std::uint32_t prefix;
        std::uint32_t length;
        char last;
    };
    std::vector<Entry> entries_;
};

/// Numbers of so many bits, most significant first.
class BitReader {
  public:
    explicit BitReader(std::string_view bytes) : bytes_(bytes) {}

    [[nodiscard]] bool has(unsigned bits) const { return at_ + bits <= 8 * bytes_.size(); }
    std::size_t next(unsigned bits) {
        std::size_t value = 0;
        for (; bits > 0; --bits, ++at_) {
            value = value << 1U | (static_cast<unsigned char>(bytes_[at_ / 8]) >> (7 - at_ % 8) & 1U);
        }
        return value;
    }

  private:
    std::string_view bytes_;
    std::size_t at_ = 0;
};

}  // namespace

std::vector<ZarMember> zar_members(std::string_view bytes, const std::filesystem::path& file) {
    if (bytes.starts_with("PK")) {
        throw InputError(fmt::format("{}: is a ZIP archive, expected one of Zemax's; unpack it", file.string()));
    }
    std::vector<ZarMember> members;
    for (std::size_t at = 0; at < bytes.size();) {
        const auto first = static_cast<unsigned char>(bytes[at]);
        const auto* layout = std::ranges::find(kLayouts, first, &Layout::first_byte);
        if (layout == std::end(kLayouts) || bytes.size() - at < layout->header || members.size() == kMostMembers) {
            throw InputError(
                fmt::format("{}: byte {} begins no record of a Zemax archive, expected EC or EA and a "
                            "header, and up to {} of them",
                            file.string(), at, kMostMembers));
        }
        const std::string_view header = bytes.substr(at, layout->header);
        const std::uint64_t size = little_endian(header.substr(layout->size_at, layout->size_bytes));
        at += layout->header;
        if (size > bytes.size() - at) {
            throw InputError(fmt::format("{}: a record of {} bytes at byte {} is longer than the rest of the file",
                                         file.string(), size, at));
        }
        ZarMember member{.name = name_in(header, *layout), .packed = bytes.substr(at, size)};
        member.is_lzw = member.name.size() > 4 && upper_case(member.name.substr(member.name.size() - 4)) == ".LZW";
        if (member.is_lzw) {
            member.name.resize(member.name.size() - 4);
        }
        members.push_back(std::move(member));
        at += size;
    }
    return members;
}

std::string unpacked(const ZarMember& member, const std::filesystem::path& file) {
    const auto refuse = [&](const std::string& why) {
        throw InputError(fmt::format("{}: {} in it {}", file.string(), printable(member.name), why));
    };
    if (!member.is_lzw) {
        return std::string(member.packed);
    }
    std::string out;
    LzwTable table;
    BitReader bits(member.packed);
    unsigned width = 9;
    std::optional<std::size_t> previous;
    while (bits.has(width)) {
        const std::size_t code = bits.next(width);
        if (code > table.size() || (code == table.size() && !previous)) {
            refuse(fmt::format("is no LZW stream: code {} of {}", code, table.size()));
        }
        const bool is_new = code == table.size();  // the last word and its own first byte
        if (out.size() + table.length(is_new ? *previous : code) + 1 > kMostBytes) {
            refuse(fmt::format("is longer than {} MiB", kMostBytes >> 20U));
        }
        const char first = table.append(is_new ? *previous : code, out);
        if (is_new) {
            out += first;
        }
        if (previous) {
            table.add(*previous, first);
        }
        previous = code;
        if (table.size() >= std::size_t{1} << width) {
            ++width;
        }
    }
    return out;
}

}  // namespace lensproof::formats
