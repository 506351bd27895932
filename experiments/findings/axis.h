// experiments/findings/axis.h — what an experiment runs over.
#pragma once
#include <string>
#include <vector>

#include "engine/base/json.h"
#include "engine/base/toml.h"

namespace lensproof::findings {

/// A quantity that an experiment sets, and its values: texts or numbers.
struct Axis {
    std::string key;  // "f_number", or a path of keys: "camera.f_number", which is called by its last
    std::vector<std::string> texts{};
    std::vector<double> numbers{};

    [[nodiscard]] bool is_text() const { return !texts.empty(); }
    [[nodiscard]] std::size_t size() const { return is_text() ? texts.size() : numbers.size(); }
    [[nodiscard]] bool is_swept() const { return size() > 1; }
    /// "f/5.6", "10°"; of a file its name without folder and ending; of what has no unit known here "blades 7".
    [[nodiscard]] std::string label(std::size_t i) const;
    /// "Field angle", in its unit "°"
    [[nodiscard]] std::string title() const;
    [[nodiscard]] std::string unit() const;
    [[nodiscard]] Json json(std::size_t i) const;
};

/// The axis that the table states under `key`: a value or a list of them, each once, 1000 at most; numbers also as a
/// range {from, to, count} or {from, to, step}, with spacing = "logarithmic" where they are to be in equal ratios.
/// Throws InputError, also for numbers beyond what is known of the key.
Axis read_text_axis(TomlTable& table, const std::string& key);
Axis read_number_axis(TomlTable& table, const std::string& key);
/// The same of texts that are read already.
Axis text_axis(const TomlTable& table, const std::string& key, std::vector<std::string> texts);

/// A place in each axis: of all combinations the i-th, the last axis running fastest.
std::vector<std::size_t> place_of(const std::vector<Axis>& axes, std::size_t i);
/// How many there are; 2³⁰ for all that is more.
std::size_t combinations(const std::vector<Axis>& axes);

/// The axis of that key; none: nullptr.
const Axis* axis_named(const std::vector<Axis>& axes, const std::string& key);

}  // namespace lensproof::findings
