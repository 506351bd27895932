// engine/io/text.h — pieces of text files: cut, read as numbers, shown in messages.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace lensproof {

/// `text` without the blanks, tabs and line ends around it.
std::string_view trimmed(std::string_view text);

/// `text` without the byte order mark that some programs write before UTF-8.
std::string_view without_byte_order_mark(std::string_view text);

/// The number that the whole of `text` is, whatever the locale: "1.5", "+2", "-3e-4", and also "inf" and "nan".
/// Nothing where it is no number, or one that a double cannot hold.
std::optional<double> parse_number(std::string_view text);

/// The start of a text for a message, without what a terminal would act upon.
std::string printable(std::string_view text);

}  // namespace lensproof
