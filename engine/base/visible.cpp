#include "engine/base/visible.h"

#include <fmt/format.h>

#include <cstddef>
#include <iterator>

namespace lensproof {

namespace {

constexpr char32_t kNoLetter = 0xfffd;

struct Letter {
    char32_t code = kNoLetter;
    std::size_t bytes = 1;
};

/// The letter that `text`, which is not empty, begins with; the replacement of one byte where that is no UTF-8.
Letter first_letter(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    if (byte(0) < 0x80) {
        return {byte(0), 1};
    }
    const std::size_t bytes = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
    if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < bytes) {
        return {};
    }
    char32_t code = byte(0) & (0xffU >> (bytes + 1));
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xc0U) != 0x80U) {
            return {};
        }
        code = (code << 6U) | (byte(i) & 0x3fU);
    }
    const bool is_too_long = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
    const bool is_no_letter = (code >= 0xd800 && code < 0xe000) || code > 0x10ffff;
    return is_too_long || is_no_letter ? Letter{} : Letter{code, bytes};
}

bool is_hidden(char32_t code) {
    const auto within = [code](char32_t first, char32_t last) { return code >= first && code <= last; };
    return (code < 0x20 && code != '\n' && code != '\t') || within(0x7f, 0x9f) || code == 0x61c ||
           within(0x200b, 0x200f) || within(0x2028, 0x202e) || within(0x2060, 0x206f) || code == 0xfeff;
}

std::string shown_with(std::string_view text, bool breaks_lines) {
    std::string shown;
    shown.reserve(text.size());
    while (!text.empty()) {
        const Letter letter = first_letter(text);
        if (is_hidden(letter.code) || (letter.code == '\n' && !breaks_lines)) {
            fmt::format_to(std::back_inserter(shown), "\\u{:04x}", static_cast<unsigned>(letter.code));
        } else if (letter.code == kNoLetter) {
            shown += "\xef\xbf\xbd";
        } else {
            shown += text.substr(0, letter.bytes);
        }
        text.remove_prefix(letter.bytes);
    }
    return shown;
}

}  // namespace

std::string visible(std::string_view text) {
    return shown_with(text, true);
}

std::string visible_in_line(std::string_view text) {
    return shown_with(text, false);
}

}  // namespace lensproof
