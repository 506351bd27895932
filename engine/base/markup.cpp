#include "engine/base/markup.h"

#include <algorithm>
#include <cstdint>

#include "engine/base/utf8.h"

namespace lensproof {

namespace {

constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";  // base64

constexpr std::string_view kReplacement = "\uFFFD";

bool is_forbidden_in_xml(char32_t code) {
    const bool is_control = (code < 0x20 && code != '\n' && code != '\t') || (code >= 0x7F && code < 0xA0);
    const bool reorders = (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
    const bool is_no_character = (code & 0xFFFEU) == 0xFFFE;
    return is_control || reorders || is_no_character;
}

/// Calls `visit` with every character of `text`; what is none, or forbidden, comes byte by byte, as U+FFFD.
template <class Visitor>
void for_each_character(std::string_view text, Visitor&& visit) {
    while (!text.empty()) {
        const Letter letter = first_letter(text);
        const bool is_shown = (letter.code != kNoLetter || letter.bytes > 1) && !is_forbidden_in_xml(letter.code);
        visit(is_shown ? text.substr(0, letter.bytes) : kReplacement);
        text.remove_prefix(is_shown ? letter.bytes : 1);
    }
}

}  // namespace

std::vector<std::string_view> markup_characters(std::string_view text) {
    std::vector<std::string_view> found;
    for_each_character(text, [&](std::string_view character) { found.push_back(character); });
    return found;
}

std::string escape_markup(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for_each_character(text, [&](std::string_view character) {
        switch (character.front()) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += character;
        }
    });
    return out;
}

std::string base64(std::string_view bytes) {
    const auto byte = [&](std::size_t i) -> std::uint32_t {
        return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0u;
    };
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::uint32_t group = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
        const std::size_t sextets = std::min<std::size_t>(bytes.size() - i, 3) + 1;
        for (std::size_t k = 0; k < 4; ++k) {
            out += k < sextets ? kAlphabet[group >> (18 - 6 * k) & 63u] : '=';
        }
    }
    return out;
}

std::optional<std::string> from_base64(std::string_view text) {
    const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with('=') ? 1 : 0;
    if (text.size() % 4 != 0) {
        return std::nullopt;
    }
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3);
    std::uint32_t group = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool is_padding = i >= text.size() - padding;
        const std::size_t sextet = is_padding ? 0 : kAlphabet.find(text[i]);
        if (sextet == std::string_view::npos) {
            return std::nullopt;
        }
        group = group << 6 | static_cast<std::uint32_t>(sextet);
        if (i % 4 == 3) {
            for (const unsigned shift : {16U, 8U, 0U}) {
                bytes += static_cast<char>(group >> shift & 255U);
            }
        }
    }
    bytes.resize(bytes.size() - padding);
    return bytes;
}

}  // namespace lensproof
