#include "experiments/draw/ticks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace lensproof::draw {

namespace {

/// A step of 1, 2 or 5 times 10^power.
struct Step {
    std::int64_t factor = 1;
    int power = 0;

    /// `index` steps from 0, correctly rounded: doubles hold powers of ten up to 10²² exactly, so that one operation
    /// with them rounds once; beyond, the decimal number is read as text.
    [[nodiscard]] double value(std::int64_t index) const {
        const auto whole = static_cast<double>(index * factor);
        if (std::abs(power) <= 22) {
            return power >= 0 ? whole * std::pow(10.0, power) : whole / std::pow(10.0, -power);
        }
        const std::string text = fmt::format("{}e{}", index * factor, power);
        double value = 0.0;
        std::from_chars(text.data(), text.data() + text.size(), value);
        return value;
    }
    [[nodiscard]] double size() const { return value(1); }
    [[nodiscard]] Step larger() const {
        return factor == 1 ? Step{2, power} : factor == 2 ? Step{5, power} : Step{1, power + 1};
    }
    [[nodiscard]] Step minor() const {
        return factor == 1 ? Step{2, power - 1} : factor == 2 ? Step{5, power - 1} : Step{1, power};
    }
    /// The first index whose value is not below `value`, and the last whose value is not above it. The quotient is off
    /// by rounding at most; the values themselves decide.
    [[nodiscard]] std::int64_t at_or_above(double low) const {
        std::int64_t index = std::llround(std::floor(low / size())) - 1;
        while (value(index) < low) {
            ++index;
        }
        return index;
    }
    [[nodiscard]] std::int64_t at_or_below(double high) const {
        std::int64_t index = std::llround(std::ceil(high / size())) + 1;
        while (value(index) > high) {
            --index;
        }
        return index;
    }
};

Step step_for(double low, double high, int most) {
    const double span = high - low;
    Step step{1, static_cast<int>(std::floor(std::log10(span / most))) - 1};
    while (step.at_or_below(high) - step.at_or_above(low) + 1 > most) {
        step = step.larger();
    }
    return step;
}

int floor_log10(double value) {
    return static_cast<int>(std::floor(std::log10(value)));
}

/// 0 for what reads well as it is, otherwise a multiple of 3.
int common_exponent(double low, double high) {
    const double largest = std::max(std::abs(low), std::abs(high));
    const bool is_plain = largest < 1e5 && largest >= 1e-3;
    return is_plain || largest == 0.0 ? 0 : 3 * static_cast<int>(std::floor(floor_log10(largest) / 3.0));
}

/// The powers of ten from `low` up to `high`.
std::vector<int> decades(double low, double high) {
    std::vector<int> found;
    for (int n = floor_log10(low) - 1; n <= floor_log10(high) + 1; ++n) {
        const double value = Step{1, n}.size();
        if (value >= low && value <= high) {
            found.push_back(n);
        }
    }
    return found;
}

void add_within(std::vector<double>& marks, double value, double low, double high) {
    if (value >= low && value <= high) {
        marks.push_back(value);
    }
}

double multiple_of_decade(int factor, int power) {
    return Step{factor, power}.size();
}

std::string plain_text(double value) {
    const int decimals = std::max(0, -floor_log10(value));
    return decimal_text(value, decimals);
}

bool reads_plainly(double low, double high) {
    return low >= 1e-3 && high <= 1e4;
}

Ticks one_two_five(double low, double high) {
    Ticks ticks;
    const bool plain = reads_plainly(low, high);
    ticks.exponent = plain ? 0 : 3 * static_cast<int>(std::floor(floor_log10(high) / 3.0));
    for (int n = floor_log10(low) - 1; n <= floor_log10(high) + 1; ++n) {
        for (int factor = 1; factor < 10; ++factor) {
            const bool is_major = factor == 1 || factor == 2 || factor == 5;
            add_within(is_major ? ticks.major : ticks.minor, multiple_of_decade(factor, n), low, high);
        }
    }
    for (const double value : ticks.major) {
        ticks.labels.push_back(plain_text(value / std::pow(10.0, ticks.exponent)));
    }
    return ticks;
}

}  // namespace

std::string decimal_text(double value, int decimals) {
    std::string digits = fmt::format("{:.{}f}", value, decimals);
    const bool is_zero = digits.find_first_of("123456789") == std::string::npos;
    if (digits.front() == '-') {
        digits = (is_zero ? "" : "\u2212") + digits.substr(1);
    }
    return digits;
}

std::string power_of_ten_text(int exponent) {
    static constexpr std::array kRaised = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text = exponent < 0 ? "10⁻" : "10";
    for (const char digit : std::to_string(std::abs(exponent))) {
        text += kRaised[static_cast<std::size_t>(digit - '0')];
    }
    return text;
}

std::string short_number(double value, int digits) {
    if (!std::isfinite(value)) {
        return "—";
    }
    if (value == 0.0) {
        return "0";
    }
    // The exponent after rounding: 0.9996 to three digits is 1.00.
    const std::string rounded = fmt::format("{:.{}e}", value, digits - 1);
    const int exponent = std::stoi(rounded.substr(rounded.find('e') + 1));
    const bool plain = exponent >= -3 && exponent < 5;
    const double shown = plain ? value : std::stod(rounded.substr(0, rounded.find('e')));
    std::string text = decimal_text(shown, std::max(0, digits - 1 - (plain ? exponent : 0)));
    if (text.find('.') != std::string::npos) {
        text.erase(text.find_last_not_of('0') + 1);
        if (text.back() == '.') {
            text.pop_back();
        }
    }
    return plain ? text : text + "×" + power_of_ten_text(exponent);
}

Ticks linear_ticks(double low, double high, int most) {
    const Step step = step_for(low, high, std::max(most, 2));
    Ticks ticks;
    ticks.exponent = common_exponent(low, high);
    const int decimals = std::max(0, ticks.exponent - step.power);
    const std::int64_t last = step.at_or_below(high);
    for (std::int64_t i = step.at_or_above(low); i <= last; ++i) {
        ticks.major.push_back(step.value(i));
        ticks.labels.push_back(decimal_text(Step{step.factor, step.power - ticks.exponent}.value(i), decimals));
    }
    const Step minor = step.minor();
    const std::int64_t per_major = step.factor == 2 ? 4 : 5;
    const std::int64_t last_minor = minor.at_or_below(high);
    for (std::int64_t i = minor.at_or_above(low); i <= last_minor; ++i) {
        if (i % per_major != 0) {
            ticks.minor.push_back(minor.value(i));
        }
    }
    return ticks;
}

Ticks log_ticks(double low, double high, int most) {
    const std::vector<int> powers = decades(low, high);
    if (powers.size() < 2) {
        Ticks ticks = one_two_five(low, high);
        return ticks.major.size() < 3 ? linear_ticks(low, high, most) : ticks;
    }
    const auto count = static_cast<int>(powers.size());
    int stride = 1;
    for (const int candidate : {1, 2, 3, 5, 10, 20, 50, 100}) {
        stride = candidate;
        if ((count + candidate - 1) / candidate <= std::max(most, 2)) {
            break;
        }
    }
    const bool plain = reads_plainly(low, high);
    Ticks ticks;
    for (int n = powers.front() - 1; n <= powers.back(); ++n) {
        const double decade = multiple_of_decade(1, n);
        if (n % stride == 0) {
            const std::size_t before = ticks.major.size();
            add_within(ticks.major, decade, low, high);
            if (ticks.major.size() > before) {
                ticks.labels.push_back(plain ? plain_text(decade) : power_of_ten_text(n));
            }
        } else {
            add_within(ticks.minor, decade, low, high);
        }
        for (int factor = 2; factor < 10 && stride == 1; ++factor) {
            add_within(ticks.minor, multiple_of_decade(factor, n), low, high);
        }
    }
    return ticks;
}

AxisRange rounded_outwards(AxisRange range, int most) {
    const Step step = step_for(range.low, range.high, std::max(most, 2)).minor();
    return {step.value(step.at_or_above(range.low) - (step.value(step.at_or_above(range.low)) > range.low ? 1 : 0)),
            step.value(step.at_or_below(range.high) + (step.value(step.at_or_below(range.high)) < range.high ? 1 : 0))};
}

AxisRange log_rounded_outwards(AxisRange range) {
    const bool whole_decades = range.high >= 10.0 * range.low;
    AxisRange rounded{0.0, 0.0};
    for (int n = floor_log10(range.low) - 1; n <= floor_log10(range.high) + 2; ++n) {
        for (const int factor : {1, 2, 5}) {
            if (factor > 1 && whole_decades) {
                continue;
            }
            const double value = multiple_of_decade(factor, n);
            if (value <= range.low) {
                rounded.low = value;
            }
            if (value >= range.high && value > rounded.low && rounded.high == 0.0) {
                rounded.high = value;
            }
        }
    }
    return rounded;
}

}  // namespace lensproof::draw
