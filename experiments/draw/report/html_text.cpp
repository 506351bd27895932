#include "experiments/draw/report/html_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "engine/base/json.h"

namespace lensproof::draw {
namespace {

// to_chars, not printf: the page has the same bytes in every locale.
std::string decimal(double value, std::chars_format format, int precision) {
    std::array<char, 400> buffer{};  // the longest fixed double has 309 digits before the point
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format, precision).ptr;
    return {buffer.data(), end};
}

std::string with_true_minus(const std::string& digits) {
    return !digits.empty() && digits.front() == '-' ? "\u2212" + digits.substr(1) : digits;
}

}  // namespace

std::string json_for_script(const Json& json) {
    const std::string plain = json.dump();
    std::string out;
    out.reserve(plain.size());
    for (const char c : plain) {  // these three stand only inside strings, where an escape means the same character
        switch (c) {
            case '<':
                out += "\\u003c";
                break;
            case '>':
                out += "\\u003e";
                break;
            case '&':
                out += "\\u0026";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::string number_text(double value) {
    if (!std::isfinite(value)) return "—";
    return with_true_minus(decimal(value == 0 ? 0.0 : value, std::chars_format::general, 6));
}

std::string floor_text(double value) {
    return std::isfinite(value) ? decimal(value, std::chars_format::general, 2) : "—";
}

std::string measurement_text(double value, std::optional<double> sigma) {
    if (!std::isfinite(value) || !sigma || !std::isfinite(*sigma) || *sigma <= 0) return number_text(value);
    // The second significant digit of sigma as it will be printed: 0.0996 rounds to 0.10, not to 0.100.
    const std::string two_digits = decimal(*sigma, std::chars_format::scientific, 1);
    const int exponent = std::stoi(two_digits.substr(two_digits.find('e') + 1));
    const int places = 1 - exponent;
    if (places > 12 || places < -6) return number_text(value) + " ± " + number_text(*sigma);
    const int shown = std::max(places, 0);
    const std::string digits = decimal(value, std::chars_format::fixed, shown);
    const bool is_zero = digits.find_first_of("123456789") == std::string::npos;  // no "-0.00"
    return with_true_minus(is_zero ? decimal(0.0, std::chars_format::fixed, shown) : digits) + " ± " +
           decimal(*sigma, std::chars_format::fixed, shown);
}

}  // namespace lensproof::draw
