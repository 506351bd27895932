#include "engine/base/visible.h"

#include <fmt/format.h>

#include <iterator>

#include "engine/base/utf8.h"

namespace lensproof {

namespace {

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
