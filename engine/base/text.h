// engine/base/text.h — pieces of text files: cut, read as numbers, shown in messages.
#pragma once
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace lensproof {

/// `text` without the blanks, tabs and line ends around it.
std::string_view trimmed(std::string_view text);

/// `text` without the byte order mark that some programs write before UTF-8.
std::string_view without_byte_order_mark(std::string_view text);

/// The lines of a text, at LF, CR LF or CR. They look into `text`.
std::vector<std::string_view> lines_of(std::string_view text);

/// The words of a line, at blanks and tabs. They look into `line`.
std::vector<std::string_view> words_of(std::string_view line);

/// `text` in ASCII's small letters, in its capitals.
std::string lower_case(std::string_view text);
std::string upper_case(std::string_view text);

/// The Number that the whole of `text` is as std::from_chars reads it: no blank, no plus.
template <class Number>
std::optional<Number> parse_exact(std::string_view text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

/// The number that the whole of `text` is, whatever the locale: "1.5", "+2", "-3e-4", and also "inf" and "nan".
/// Nothing where it is no number, or one that a double cannot hold.
std::optional<double> parse_number(std::string_view text);

/// A count that a file states as any number: its whole part, held within [low, high]; NaN counts as low.
int whole_number_within(double value, int low, int high);

/// The start of a text for a message, as `visible` (engine/base/visible.h) shows it.
std::string printable(std::string_view text);

}  // namespace lensproof
