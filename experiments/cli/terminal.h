// experiments/cli/terminal.h — the one door to people's terminals: nothing in a text steers them.
#pragma once
#include <fmt/format.h>

#include <string_view>

namespace lensproof::cli {

/// Writes the text to standard output, or to standard error, as `visible` (engine/base/visible.h) shows it: whoever
/// chose a name in it may have put anything there.
void show(std::string_view text);
void show_message(std::string_view text);

/// The same of a format and what goes into it, to standard output: what a command found.
template <class... Args>
void print(fmt::format_string<const Args&...> format, const Args&... args) {
    show(fmt::format(format, args...));
}

/// To standard error: what there is to know of it.
template <class... Args>
void print_message(fmt::format_string<const Args&...> format, const Args&... args) {
    show_message(fmt::format(format, args...));
}

}  // namespace lensproof::cli
