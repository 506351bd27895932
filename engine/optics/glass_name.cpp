#include "engine/optics/glass_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "engine/base/text.h"

namespace lensproof::optics {

namespace {

char capital(char letter) {
    return static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
}

bool is_alphanumeric(char letter) {
    return std::isalnum(static_cast<unsigned char>(letter)) != 0;
}

bool all_digits(std::string_view text) {
    return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

/// The number whose digits these are, with a point behind the first `whole` of them; rounded once, as when it is read.
double with_point(std::string_view digits, std::size_t whole) {
    double value = 0.0;
    for (const char digit : digits) {
        value = 10.0 * value + (digit - '0');
    }
    return value / std::pow(10.0, static_cast<double>(digits.size() - whole));
}

/// From the digits behind the 1 of n_d and those of V_d, the first two of which stand before its point.
std::optional<GlassCode> from_digits(std::string_view index, std::string_view abbe) {
    constexpr double kLeastIndex = 1.3;  // no glass has less: 001 is 2.001
    GlassCode code{.n_d = with_point(fmt::format("1{}", index), 1), .V_d = with_point(abbe, 2)};
    if (code.n_d < kLeastIndex) {
        code.n_d = with_point(fmt::format("2{}", index), 1);
    }
    return code.V_d >= 10.0 ? std::optional(code) : std::nullopt;
}

}  // namespace

bool same_letters(std::string_view a, std::string_view b) {
    return std::ranges::equal(a, b, {}, capital, capital);
}

bool same_spelling(std::string_view a, std::string_view b) {
    auto i = a.begin();
    auto j = b.begin();
    while (true) {
        i = std::find_if(i, a.end(), is_alphanumeric);
        j = std::find_if(j, b.end(), is_alphanumeric);
        if (i == a.end() || j == b.end()) {
            return i == a.end() && j == b.end();
        }
        if (capital(*i++) != capital(*j++)) {
            return false;
        }
    }
}

std::string bare_name(std::string_view name) {
    std::string bare;
    for (const char letter : name) {
        if (is_alphanumeric(letter)) {
            bare += capital(letter);
        }
    }
    return bare;
}

std::optional<GlassCode> parse_glass_code(std::string_view text) {
    text = trimmed(text);
    constexpr std::size_t kLongest = 16;
    if (text.size() > kLongest) {
        return std::nullopt;
    }
    if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) {
        const std::optional<double> n_d = parse_number(text.substr(0, colon));
        const std::optional<double> V_d = parse_number(text.substr(colon + 1));
        const bool plausible = n_d && V_d && *n_d > 1.0 && *n_d < 4.0 && *V_d > 1.0 && *V_d < 1000.0;
        return plausible ? std::optional(GlassCode{*n_d, *V_d}) : std::nullopt;
    }
    const std::size_t point = std::min(text.find('.'), text.size());
    const std::string_view before = text.substr(0, point);
    const std::string_view after = point < text.size() ? text.substr(point + 1) : "";
    if (!all_digits(before) || (point < text.size() && !all_digits(after))) {
        return std::nullopt;
    }
    const bool six_and_density = before.size() == 6 && (after.empty() || after.size() == 3);
    if (six_and_density && !(point < text.size() && after.empty())) {
        return from_digits(before.substr(0, 3), before.substr(3));
    }
    if (before.size() >= 3 && before.size() <= 6 && after.size() >= 3) {
        return from_digits(before, after);
    }
    return std::nullopt;
}

}  // namespace lensproof::optics
