// experiments/studies/sweeps/sweep_axes.h — what a sweep runs over.
#pragma once
#include <string>
#include <vector>

#include "engine/base/json.h"
#include "engine/base/toml.h"

namespace lensproof::studies {

/// A quantity that a sweep sets, and its values: texts or numbers.
struct SweepAxis {
    std::string key;  // "f_number"
    std::vector<std::string> texts{};
    std::vector<double> numbers{};

    [[nodiscard]] bool is_text() const { return !texts.empty(); }
    [[nodiscard]] std::size_t size() const { return is_text() ? texts.size() : numbers.size(); }
    [[nodiscard]] bool is_swept() const { return size() > 1; }
    /// "f/5.6", "10°"
    [[nodiscard]] std::string label(std::size_t i) const;
    /// "Field", in its unit "°"
    [[nodiscard]] std::string title() const;
    [[nodiscard]] std::string unit() const;
    [[nodiscard]] Json json(std::size_t i) const;
};

/// The axes that a table states, those that change a lens first and those that it is looked at by last: lens, zoom,
/// f_number, focus_distance_mm (inf is allowed), image_shift_mm, model, frequency_per_mm, field_deg, wavelength_nm.
/// Each is a value, a list of them, or, of numbers, a range {from, to, count} or {from, to, step}, with spacing =
/// "logarithmic" where they are to be in equal ratios. All but lens are optional.
std::vector<SweepAxis> read_sweep_axes(TomlTable& table);

/// A place in each axis: of all combinations the i-th, the last axis running fastest.
std::vector<std::size_t> place_of(const std::vector<SweepAxis>& axes, std::size_t i);
std::size_t combinations(const std::vector<SweepAxis>& axes);

/// The axis of that key; none: nullptr.
const SweepAxis* axis_named(const std::vector<SweepAxis>& axes, const std::string& key);

}  // namespace lensproof::studies
