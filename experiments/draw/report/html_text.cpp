#include "experiments/draw/report/html_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/markup.h"
#include "experiments/draw/ticks.h"

namespace lensproof::draw {

std::string json_for_script(const Json& json) {
    const std::string plain = json.dump();
    std::string out;
    out.reserve(plain.size());
    for (const char c : plain) {  // these three stand only inside strings, where an escape means the same character
        out += c == '<' || c == '>' || c == '&' ? fmt::format("\\u{:04x}", c) : std::string(1, c);
    }
    return out;
}

std::optional<double> as_number(const Json& value) {
    if (!value.is_number() || !std::isfinite(value.number())) return std::nullopt;
    return value.number();
}

std::string as_text(const Json& value) {
    if (value.is_text()) return value.text();
    if (value.is_null()) return "";
    if (value.is_number() && !value.is_whole()) return number_text(value.number());
    return value.dump();
}

std::string text(const Json& object, const char* key) {
    return escape_markup(as_text(object[key]));
}

std::string with_unit(const std::string& number, const std::string& unit) {
    return unit.empty() || unit == "°" ? number + unit : number + "\u00a0" + unit;
}

std::optional<std::size_t> subject_colour(const Json& report, const Json& id) {
    const Json::List& subjects = report["subjects"].elements();
    for (std::size_t i = 0; i < subjects.size() && id.is_text(); ++i) {
        if (subjects[i]["id"] == id) return i % kSubjectColours;
    }
    return std::nullopt;
}

std::string verdict_class(const Json& object) {
    const std::string word = as_text(object["verdict"]);
    return word == "PASS" ? "pass" : word == "FAIL" ? "fail" : "inconclusive";
}

std::string number_text(double value) {
    if (!std::isfinite(value)) return "—";
    return (value < 0 ? "\u2212" : "") + fmt::format("{:.6g}", std::abs(value));
}

std::string floor_text(double value) {
    return std::isfinite(value) ? fmt::format("{:.2g}", value) : "—";
}

std::string measurement_text(double value, std::optional<double> sigma) {
    if (!std::isfinite(value) || !sigma || !std::isfinite(*sigma) || *sigma <= 0) return number_text(value);
    // The second significant digit of sigma as it will be printed: 0.0996 rounds to 0.10, not to 0.100.
    const std::string two_digits = fmt::format("{:.1e}", *sigma);
    const int places = 1 - std::stoi(two_digits.substr(two_digits.find('e') + 1));
    if (places > 12 || places < -6) return number_text(value) + " ± " + number_text(*sigma);
    const int shown = std::max(places, 0);
    return decimal_text(value, shown) + " ± " + decimal_text(*sigma, shown);
}

}  // namespace lensproof::draw
