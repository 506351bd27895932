// engine/formats/prescription/design_command.h — a keyword and its words at a line of a design program's file.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lensproof::formats {

/// Throws InputError as "file:line: SURF 3: CURV is "x", expected a curvature" for words that are not what they should
/// be.
struct Command {
    const std::filesystem::path* file = nullptr;
    int line = 0;
    std::string context;  // "SURF 3: ", or nothing
    std::string keyword;
    std::vector<std::string_view> words;

    /// Nothing where there is no such word.
    [[nodiscard]] std::string_view word(std::size_t index) const;
    [[nodiscard]] double number(std::size_t index, std::string_view expected) const;
    /// Zero where there is no such word.
    [[nodiscard]] double number_or_zero(std::size_t index) const;
    /// A whole number from `min` to `max`.
    [[nodiscard]] int integer(std::size_t index, int min, int max, std::string_view expected) const;
    /// Of all words from `first` on.
    [[nodiscard]] std::vector<double> numbers_from(std::size_t first) const;
    [[noreturn]] void fail(std::string_view found, std::string_view expected) const;
};

}  // namespace lensproof::formats
