#include "experiments/studies/tradeoff/tolerance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "engine/base/input_error.h"
#include "engine/base/text.h"

namespace lensproof::studies {

namespace {

struct TolerancePart {
    Measured found;
    double limit = 0.0;
    const char* unit = nullptr;
};

std::array<TolerancePart, 3> parts_of(const Contribution& found, const Tolerance& tolerance) {
    return {TolerancePart{found.px, tolerance.px, "px"}, TolerancePart{found.ev, tolerance.ev, "EV"},
            TolerancePart{found.ciede2000, tolerance.ciede2000, "CIEDE2000"}};
}

}  // namespace

Tolerance parse_tolerance(const std::string& text) {
    if (text == "visible") {
        return {.px = 1.0, .ev = 0.03, .ciede2000 = 1.0};
    }
    const auto refuse = [&](const std::string& part) {
        throw InputError(
            fmt::format("--tolerance is \"{}\": {}, expected numbers above 0 with px, ev and de, such as "
                        "0.5px,0.02ev,1de, or visible",
                        text, part));
    };
    Tolerance tolerance;
    std::vector<std::string> seen;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string part = text.substr(begin, end - begin);
        begin = end + 1;
        const std::string unit = part.substr(part.size() - std::min<std::size_t>(2, part.size()));
        const std::optional<double> number = parse_number(part.substr(0, part.size() - unit.size()));
        if (unit != "px" && unit != "ev" && unit != "de") {
            refuse(fmt::format("\"{}\" has no unit that is known", part));
        }
        if (!number || !std::isfinite(*number) || !(*number > 0.0)) {
            refuse(fmt::format("\"{}\" is no number above 0 and a unit", part));
        }
        if (std::ranges::count(seen, unit) > 0) {
            refuse(fmt::format("{} stands twice", unit));
        }
        seen.push_back(unit);
        (unit == "px" ? tolerance.px : unit == "ev" ? tolerance.ev : tolerance.ciede2000) = *number;
    }
    return tolerance;
}

Contribution surely(const Contribution& found) {
    const auto least = [](const Measured& measured) { return Measured{std::max(0.0, at_least(measured)), 0.0}; };
    return {least(found.px), least(found.ev), least(found.ciede2000)};
}

bool keeps(const Contribution& found, const Tolerance& tolerance) {
    LeftOut alone;
    alone.add(found);
    return alone.keeps(tolerance);
}

std::string words_of(const Contribution& found) {
    std::vector<std::string> words;
    for (const TolerancePart& part : parts_of(found, {})) {
        if (at_most(part.found) > 0.0) {
            words.push_back(fmt::format("{:.2g} {}", at_most(part.found), part.unit));
        }
    }
    return words.empty() ? "nothing" : fmt::format("{}", fmt::join(words, ", "));
}

std::string excess(const Contribution& found, const Tolerance& tolerance) {
    std::vector<std::string> words;
    for (const TolerancePart& part : parts_of(found, tolerance)) {
        if (at_most(part.found) > part.limit) {
            words.push_back(fmt::format("{:.2g} {} where {:g} may be", at_most(part.found), part.unit, part.limit));
        }
    }
    return fmt::format("{}", fmt::join(words, ", "));
}

double over_tolerance(const Contribution& found, const Tolerance& tolerance) {
    double over = 0.0;
    for (const TolerancePart& part : parts_of(found, tolerance)) {
        over = std::max(over, part.found.value / part.limit);
    }
    return over;
}

void LeftOut::add(const Contribution& more) {
    px_ = std::hypot(px_, at_most(more.px));
    ev_ += at_most(more.ev);
    ciede2000_ = std::hypot(ciede2000_, at_most(more.ciede2000));
}

bool LeftOut::keeps(const Tolerance& tolerance) const {
    return px_ <= tolerance.px && ev_ <= tolerance.ev && ciede2000_ <= tolerance.ciede2000;
}

}  // namespace lensproof::studies
