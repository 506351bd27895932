#include "engine/scene/geometry/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <utility>

#include "engine/base/bytes.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"

namespace lensproof::scene {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kWord = 4;
constexpr std::size_t kJsonBegin = 5 * kWord;

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
    std::uint32_t word = 0;
    for (std::size_t i = kWord; i-- > 0;) {
        word = word << 8U | static_cast<unsigned char>(bytes[at + i]);
    }
    return word;
}

void append_word(std::string& bytes, std::size_t word) {
    for (std::size_t i = 0; i < kWord; ++i) {
        bytes += static_cast<char>(word >> (8U * i) & 0xFFU);
    }
}

/// Up to `count` bytes of a file from a place on.
std::string bytes_of(const fs::path& file, std::size_t from, std::size_t count) {
    std::ifstream stream(file, std::ios::binary);
    const std::size_t size = fs::file_size(file);
    std::string bytes(from < size ? std::min(count, size - from) : 0, '\0');
    stream.seekg(static_cast<std::streamoff>(from));
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(stream.gcount()));
    return bytes;
}

/// The length of the binary form's JSON, which follows five words: magic, version, length, and the chunk's length and
/// kind; none of the other form.
std::optional<std::size_t> json_length(const fs::path& file) {
    const std::string head = bytes_of(file, 0, kJsonBegin);
    return head.size() == kJsonBegin && head.starts_with("glTF") ? std::optional<std::size_t>(word_at(head, 3 * kWord))
                                                                 : std::nullopt;
}

int base64_digit(char c) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t at = kDigits.find(c);
    return at == std::string_view::npos ? -1 : static_cast<int>(at);
}

}  // namespace

Json gltf_json(const fs::path& file) {
    check_regular(file, "a mesh's file");
    const std::optional<std::size_t> length = json_length(file);
    const std::string text = length ? bytes_of(file, kJsonBegin, *length) : read_file(file);
    if (length && text.size() < *length) {  // for which Assimp makes room before it looks
        throw InputError(
            fmt::format("{}: is cut off: {} bytes of JSON, {} are there", file.string(), *length, text.size()));
    }
    Json json = Json::parse(text, file.string());
    const Json& version = std::as_const(json)["asset"]["version"];
    if (!version.is_text() || !version.text().starts_with("2")) {
        throw InputError(fmt::format("{}: is no glTF of version 2, of which alone meshes are read", file.string()));
    }
    return json;
}

std::string glb_buffer(const fs::path& file) {
    const std::optional<std::size_t> length = json_length(file);
    if (!length) {
        return {};
    }
    const std::size_t begin = kJsonBegin + *length;
    const std::string head = bytes_of(file, begin, 2 * kWord);
    return head.size() == 2 * kWord ? bytes_of(file, begin + 2 * kWord, word_at(head, 0)) : std::string();
}

std::string gltf_with_json(const fs::path& file, const Json& json) {
    std::string text = json.dump();
    const std::optional<std::size_t> length = json_length(file);
    if (!length) {
        return text;
    }
    text.append((kWord - text.size() % kWord) % kWord, ' ');
    const std::string rest = bytes_of(file, kJsonBegin + *length, fs::file_size(file));
    std::string bytes = bytes_of(file, 0, 2 * kWord);
    append_word(bytes, kJsonBegin + text.size() + rest.size());
    append_word(bytes, text.size());
    return bytes + "JSON" + text + rest;
}

std::string data_uri_bytes(std::string_view uri, const std::string& place) {
    constexpr std::string_view kMark = ";base64,";
    const std::size_t mark = uri.find(kMark);
    if (mark == std::string_view::npos) {
        throw InputError(fmt::format("{}: is a data URI without base64, expected \"data:…;base64,…\"", place));
    }
    std::string_view digits = uri.substr(mark + kMark.size());
    while (digits.ends_with('=')) {
        digits.remove_suffix(1);
    }
    std::string bytes;
    bytes.reserve(digits.size() * 3 / 4);
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : digits) {
        const int digit = base64_digit(c);
        if (digit < 0) {
            throw InputError(fmt::format("{}: is a data URI whose base64 has a character of code {}", place,
                                         static_cast<int>(static_cast<unsigned char>(c))));
        }
        bits = bits << 6U | static_cast<std::uint32_t>(digit);
        if ((count += 6) >= 8) {
            count -= 8;
            bytes += static_cast<char>(bits >> static_cast<unsigned>(count) & 0xFFU);
        }
    }
    return bytes;
}

std::string percent_decoded(std::string_view uri) {
    std::string name;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        unsigned value = 0;
        const char* const digits = uri.data() + i + 1;
        if (uri[i] == '%' && i + 2 < uri.size() && std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
            name += static_cast<char>(value);
            i += 2;
        } else {
            name += uri[i];
        }
    }
    return name;
}

}  // namespace lensproof::scene
