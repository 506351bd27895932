// experiments/cli/terminal.h — the one door to people's terminals: nothing in a text steers them.
#pragma once
#include <fmt/format.h>

#include <string>
#include <string_view>
#include <type_traits>

#include "engine/base/visible.h"

namespace lensproof::cli {

/// Writes the text to standard output, or to standard error, as `visible` (engine/base/visible.h) shows it: whoever
/// chose a name in it may have put anything there.
void show(std::string_view text);
void show_message(std::string_view text);

/// What goes into a format, if it is a text as one that begins no line of its own.
template <class T>
auto in_line(const T& value) {
    if constexpr (std::is_convertible_v<const T&, std::string_view>) {
        return visible_in_line(value);
    } else {
        return value;
    }
}

template <class... Values>
std::string formatted(fmt::string_view format, const Values&... values) {
    return fmt::vformat(format, fmt::make_format_args(values...));
}

/// The same of a format and what goes into it, each `in_line`, to standard output: what a command found.
template <class... Args>
void print(fmt::format_string<const Args&...> format, const Args&... args) {
    show(formatted(format, in_line(args)...));
}

/// To standard error: what there is to know of it.
template <class... Args>
void print_message(fmt::format_string<const Args&...> format, const Args&... args) {
    show_message(formatted(format, in_line(args)...));
}

}  // namespace lensproof::cli
