#include "engine/check/digits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "engine/base/text.h"

namespace lensproof::check {

namespace {

constexpr double kOften = 1.0;
constexpr double kSometimes = 2.0;
constexpr double kRarely = 5.0;

// Digits that scans and eyes take for each other.
constexpr std::string_view kLookAlikes[] = {"17", "38", "56", "58", "68", "69", "08", "06",
                                            "89", "09", "39", "35", "14", "27", "49", "47"};

bool look_alike(char a, char b) {
    return std::ranges::any_of(kLookAlikes, [&](std::string_view pair) {
        return (pair[0] == a && pair[1] == b) || (pair[0] == b && pair[1] == a);
    });
}

bool is_digit(char letter) {
    return letter >= '0' && letter <= '9';
}

class Changes {
  public:
    explicit Changes(double value) : value_(value), text_(fmt::format("{:f}", std::abs(value))) {
        // The shortest form without an exponent: {} gives the digits, {:f} would pad them.
        const std::string shortest = fmt::format("{}", std::abs(value));
        if (shortest.find('e') == std::string::npos) {
            text_ = shortest;
        }
    }

    [[nodiscard]] const std::string& text() const { return text_; }

    void add(double magnitude, const char* slip, double unlikelihood) {
        add_value(std::copysign(magnitude, value_), slip, unlikelihood);
    }

    void add(const std::string& text, const char* slip, double unlikelihood) {
        if (const std::optional<double> magnitude = parse_exact<double>(text)) {
            add(*magnitude, slip, unlikelihood);
        }
    }

    void add_value(double value, const char* slip, double unlikelihood) {
        const bool is_new = value != value_ && std::ranges::none_of(found_, [&](const NumberChange& change) {
                                return std::abs(change.value - value) <= 1e-12 * std::abs(value);
                            });
        if (is_new && std::isfinite(value)) {
            found_.push_back({.value = value, .slip = slip, .unlikelihood = unlikelihood});
        }
    }

    std::vector<NumberChange> take() { return std::move(found_); }

  private:
    double value_;
    std::string text_;  // of its magnitude
    std::vector<NumberChange> found_;
};

/// To as many digits as any table has, so that 4.297 moved by a place is 42.97.
double rounded(double value) {
    return parse_exact<double>(fmt::format("{:.10g}", value)).value_or(value);
}

void add_swaps(Changes& changes) {
    const std::string& text = changes.text();
    for (std::size_t i = 0; i < text.size(); ++i) {
        std::size_t next = i + 1;
        if (next < text.size() && text[next] == '.') {
            ++next;  // across the point too
        }
        if (next < text.size() && is_digit(text[i]) && is_digit(text[next])) {
            std::string swapped = text;
            std::swap(swapped[i], swapped[next]);
            changes.add(swapped, "two digits swapped", kOften);
        }
    }
}

void add_misreadings(Changes& changes) {
    const std::string& text = changes.text();
    for (std::size_t i = 0; i < text.size(); ++i) {
        for (char digit = '0'; digit <= '9' && is_digit(text[i]); ++digit) {
            std::string misread = text;
            misread[i] = digit;
            changes.add(misread, "a digit misread", look_alike(text[i], digit) ? kSometimes : kRarely);
        }
    }
}

void add_lost_and_doubled(Changes& changes) {
    const std::string& text = changes.text();
    for (std::size_t i = 0; i <= text.size(); ++i) {
        if (i < text.size() && is_digit(text[i])) {
            std::string shorter = text;
            changes.add(shorter.erase(i, 1), "a digit too many", kRarely);
        }
        for (char digit = '0'; digit <= '9'; ++digit) {
            std::string longer = text;
            changes.add(longer.insert(i, 1, digit), "a digit left out", 2.0 * kRarely);
        }
    }
}

}  // namespace

std::vector<NumberChange> plausible_changes(double value) {
    if (!std::isfinite(value)) {
        return {};
    }
    Changes changes(value);
    changes.add_value(-value, "the sign lost", kOften);
    for (const int places : {1, -1, 2, -2, 3, -3}) {
        changes.add(rounded(std::pow(10.0, places) * std::abs(value)), "the decimal point moved", kOften);
    }
    for (const double factor : {25.4, 1.0 / 25.4}) {
        changes.add(rounded(factor * std::abs(value)), "inches for mm", kSometimes);
    }
    for (const double factor : {2.0, 0.5}) {
        changes.add(factor * std::abs(value), "a diameter for a radius", kRarely);
    }
    add_swaps(changes);
    add_misreadings(changes);
    add_lost_and_doubled(changes);
    return changes.take();
}

}  // namespace lensproof::check
