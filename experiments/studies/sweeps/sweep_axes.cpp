#include "experiments/studies/sweeps/sweep_axes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "engine/base/infinity.h"
#include "engine/formats/prescription/load_lens.h"

namespace lensproof::studies {

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

const NumberAxis* number_axis(const std::string& key) {
    const auto found =
        std::ranges::find(kNumberAxes, key, [](const NumberAxis& axis) { return std::string(axis.key); });
    return found == kNumberAxes.end() ? nullptr : &*found;
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

void check_number(const TomlTable& table, const NumberAxis& axis, double value) {
    if (!axis.bounds.hold(value) && !(axis.may_be_infinite && value == kInfinity)) {
        table.fail(axis.key, fmt::format("is {}, expected {}{}", value, axis.bounds.expectation(),
                                         axis.may_be_infinite ? ", or inf" : ""));
    }
}

std::vector<double> read_numbers(TomlTable& table, const NumberAxis& axis) {
    if (table.is_table(axis.key)) {
        return read_range(table.table(axis.key), axis.bounds);
    }
    std::vector<double> values =
        table.is_number(axis.key) ? std::vector<double>{table.any_number(axis.key)} : table.any_numbers(axis.key);
    for (const double value : values) {
        check_number(table, axis, value);
    }
    return values;
}

std::vector<std::string> read_texts(TomlTable& table, const std::string& key) {
    return table.is_text(key) ? std::vector<std::string>{table.text(key)} : table.texts(key);
}

/// In the order of the axes; each value once.
void check_axis(const TomlTable& table, const SweepAxis& axis) {
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

std::string SweepAxis::label(std::size_t i) const {
    if (is_text()) {
        return key == "lens" ? std::filesystem::path(texts[i]).stem().string() : texts[i];
    }
    const NumberAxis* axis = number_axis(key);
    return std::isinf(numbers[i]) ? "∞" : fmt::format(fmt::runtime(axis->label), numbers[i]);
}

std::string SweepAxis::title() const {
    const NumberAxis* axis = number_axis(key);
    return axis == nullptr ? key : axis->title;
}

std::string SweepAxis::unit() const {
    const NumberAxis* axis = number_axis(key);
    return axis == nullptr ? "" : axis->unit;
}

Json SweepAxis::json(std::size_t i) const {
    if (is_text()) {
        return texts[i];
    }
    return std::isinf(numbers[i]) ? Json("infinity") : Json(numbers[i]);
}

std::vector<SweepAxis> read_sweep_axes(TomlTable& table) {
    std::vector<SweepAxis> axes{{.key = "lens", .texts = formats::read_lens_names(table)}};
    const auto add_number = [&](const char* key) {
        if (table.has(key)) {
            axes.push_back({.key = key, .texts = {}, .numbers = read_numbers(table, *number_axis(key))});
        }
    };
    if (table.has("zoom")) {
        axes.push_back({.key = "zoom", .texts = read_texts(table, "zoom")});
    }
    add_number("f_number");
    add_number("focus_distance_mm");
    add_number("image_shift_mm");
    if (table.has("model")) {
        axes.push_back({.key = "model", .texts = read_texts(table, "model")});
    }
    add_number("frequency_per_mm");
    add_number("field_deg");
    add_number("wavelength_nm");
    for (const SweepAxis& axis : axes) {
        check_axis(table, axis);
    }
    return axes;
}

std::vector<std::size_t> place_of(const std::vector<SweepAxis>& axes, std::size_t i) {
    std::vector<std::size_t> place(axes.size());
    for (std::size_t a = axes.size(); a-- > 0;) {
        place[a] = i % axes[a].size();
        i /= axes[a].size();
    }
    return place;
}

std::size_t combinations(const std::vector<SweepAxis>& axes) {
    std::size_t count = 1;
    for (const SweepAxis& axis : axes) {
        constexpr std::size_t kPlenty = 1U << 30U;  // and no overflow
        count = std::min(kPlenty, count * axis.size());
    }
    return count;
}

const SweepAxis* axis_named(const std::vector<SweepAxis>& axes, const std::string& key) {
    const auto found = std::ranges::find(axes, key, &SweepAxis::key);
    return found == axes.end() ? nullptr : &*found;
}

}  // namespace lensproof::studies
