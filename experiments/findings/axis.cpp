#include "experiments/findings/axis.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "engine/base/infinity.h"

namespace lensproof::findings {

namespace {

struct NumberAxis {
    const char* key;
    const char* title;
    const char* unit;
    const char* label;  // of a value
    Bounds bounds;
    bool may_be_infinite = false;
};

constexpr std::array kNumberAxes = {
    NumberAxis{"f_number", "F-number", "", "f/{:g}", {.min = 0.1, .max = 1000.0}},
    NumberAxis{"focus_distance_mm", "Focus distance", "mm", "{:g} mm", kPositive, true},
    NumberAxis{"image_shift_mm", "Shift of the image plane", "mm", "{:+g} mm", {.min = -1e6, .max = 1e6}},
    NumberAxis{"frequency_per_mm", "Spatial frequency", "cycles/mm", "{:g}/mm", kPositive},
    NumberAxis{"field_deg", "Field angle", "°", "{:g}°", {.min = -179.9, .max = 179.9}},
    NumberAxis{"wavelength_nm", "Wavelength", "nm", "{:g} nm", {.min = 100.0, .max = 20000.0}},
};

/// "f_number" of "camera.f_number"
std::string last_key(const std::string& path) {
    return path.substr(path.rfind('.') + 1);  // npos + 1 = 0
}

const NumberAxis* number_axis(const std::string& key) {
    const auto found =
        std::ranges::find(kNumberAxes, last_key(key), [](const NumberAxis& axis) { return std::string(axis.key); });
    return found == kNumberAxes.end() ? nullptr : &*found;
}

/// Of a lens or a scene that a file states: the file's.
bool names_file(const std::string& key) {
    return last_key(key) == "lens" || last_key(key) == "scene";
}

constexpr std::size_t kMostOfAnAxis = 1000;

/// {from, to, count | step, spacing}
std::vector<double> read_range(TomlTable range, const Bounds& bounds) {
    const double from = range.number("from", bounds);
    const double to = range.number("to", bounds);
    const bool is_logarithmic =
        range.has("spacing") && range.choice("spacing", {"linear", "logarithmic"}) == "logarithmic";
    if (range.has("step") == range.has("count")) {
        range.fail("", "expected either count or step");
    }
    if (is_logarithmic && (!(from > 0.0) || !(to > 0.0) || range.has("step"))) {
        range.fail("spacing", "is \"logarithmic\", expected from and to above 0, and count");
    }
    std::size_t count = 0;
    if (range.has("count")) {
        count = static_cast<std::size_t>(range.integer("count", 2, kMostOfAnAxis));
    } else {
        const double step = range.number("step", kPositive);
        const double steps = std::floor(std::abs(to - from) / step + 1e-9);
        if (!(steps < static_cast<double>(kMostOfAnAxis))) {
            range.fail("step", fmt::format("makes {:g} values, expected {} at most", steps + 1.0, kMostOfAnAxis));
        }
        count = static_cast<std::size_t>(steps) + 1;
    }
    const double step = range.has("step") ? std::copysign(range.number("step"), to - from)
                                          : (to - from) / static_cast<double>(count - 1);
    range.finish();
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) {
        const auto k = static_cast<double>(i);
        values.push_back(is_logarithmic ? from * std::pow(to / from, k / static_cast<double>(count - 1))
                                        : from + k * step);
    }
    return values;
}

void check_number(const TomlTable& table, const std::string& key, const NumberAxis& axis, double value) {
    if (!axis.bounds.hold(value) && !(axis.may_be_infinite && value == kInfinity)) {
        table.fail(key, fmt::format("is {}, expected {}{}", value, axis.bounds.expectation(),
                                    axis.may_be_infinite ? ", or inf" : ""));
    }
}

/// Each value once.
void check_axis(const TomlTable& table, const Axis& axis) {
    if (axis.size() == 0 || axis.size() > kMostOfAnAxis) {
        table.fail(axis.key, fmt::format("has {} values, expected 1 to {}", axis.size(), kMostOfAnAxis));
    }
    for (std::size_t i = 0; i < axis.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            if (axis.label(i) == axis.label(k) && axis.json(i) == axis.json(k)) {
                table.fail(axis.key, fmt::format("has {} twice", axis.label(i)));
            }
        }
    }
}

}  // namespace

std::string Axis::label(std::size_t i) const {
    if (is_text()) {
        return names_file(key) ? std::filesystem::path(texts[i]).stem().string() : texts[i];
    }
    if (std::isinf(numbers[i])) {
        return numbers[i] > 0.0 ? "∞" : "−∞";
    }
    const NumberAxis* axis = number_axis(key);
    return axis == nullptr ? fmt::format("{} {:g}", last_key(key), numbers[i])
                           : fmt::format(fmt::runtime(axis->label), numbers[i]);
}

std::string Axis::title() const {
    const NumberAxis* axis = number_axis(key);
    return axis == nullptr ? last_key(key) : axis->title;
}

std::string Axis::unit() const {
    const NumberAxis* axis = number_axis(key);
    return axis == nullptr ? "" : axis->unit;
}

Json Axis::json(std::size_t i) const {
    if (is_text()) {
        return texts[i];
    }
    return std::isinf(numbers[i]) ? Json("infinity") : Json(numbers[i]);
}

Axis text_axis(const TomlTable& table, const std::string& key, std::vector<std::string> texts) {
    Axis axis{.key = key, .texts = std::move(texts)};
    check_axis(table, axis);
    return axis;
}

Axis read_text_axis(TomlTable& table, const std::string& key) {
    return text_axis(table, key, table.is_text(key) ? std::vector{table.text(key)} : table.texts(key));
}

Axis read_number_axis(TomlTable& table, const std::string& key) {
    const NumberAxis* known = number_axis(key);
    Axis axis{.key = key};
    if (table.is_table(key)) {
        axis.numbers = read_range(table.table(key), known == nullptr ? kAnyNumber : known->bounds);
    } else {
        axis.numbers = table.is_number(key) ? std::vector{table.any_number(key)} : table.any_numbers(key);
        for (const double value : axis.numbers) {
            if (known != nullptr) {
                check_number(table, key, *known, value);
            }
        }
    }
    check_axis(table, axis);
    return axis;
}

std::vector<std::size_t> place_of(const std::vector<Axis>& axes, std::size_t i) {
    std::vector<std::size_t> place(axes.size());
    for (std::size_t a = axes.size(); a-- > 0;) {
        place[a] = i % axes[a].size();
        i /= axes[a].size();
    }
    return place;
}

std::size_t combinations(const std::vector<Axis>& axes) {
    std::size_t count = 1;
    for (const Axis& axis : axes) {
        constexpr std::size_t kPlenty = 1U << 30U;  // and no overflow
        count = std::min(kPlenty, count * axis.size());
    }
    return count;
}

const Axis* axis_named(const std::vector<Axis>& axes, const std::string& key) {
    const auto found = std::ranges::find(axes, key, &Axis::key);
    return found == axes.end() ? nullptr : &*found;
}

}  // namespace lensproof::findings
