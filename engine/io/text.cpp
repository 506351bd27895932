#include "engine/io/text.h"

#include <algorithm>
#include <charconv>
#include <system_error>

namespace lensproof {

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlanks = " \t\r\n";
    const std::size_t first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos) {
        return {};
    }
    return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string_view without_byte_order_mark(std::string_view text) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    return text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text;
}

std::optional<double> parse_number(std::string_view text) {
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') {  // from_chars knows no plus
        text.remove_prefix(1);
    }
    double number = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

std::string printable(std::string_view text) {
    constexpr std::size_t kShown = 100;
    std::string shown(text.substr(0, kShown));
    std::ranges::replace_if(
        shown, [](unsigned char letter) { return letter < 0x20 || letter >= 0x7f; }, '?');
    return text.size() > kShown ? shown + "…" : shown;
}

}  // namespace lensproof
