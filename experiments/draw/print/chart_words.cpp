#include "experiments/draw/print/chart_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/base/input_error.h"
#include "engine/base/nearest_name.h"
#include "engine/scene/chart/chart_keys.h"

namespace lensproof::draw {

namespace {

/// The largest pitch in whole mm (below 10 mm: tenths) with which `count` cells fit on the page.
double fitting_pitch_mm(const PrintLayout& layout, scene::GridSize count) {
    const double width = layout.paper.width_mm - 2.0 * layout.margin_mm;
    const double height = layout.paper.height_mm - 2.0 * layout.margin_mm - kCaptionHeight_mm;
    const double pitch = std::min(width / count.columns, height / count.rows);
    return pitch >= 10.0 ? std::floor(pitch) : std::floor(10.0 * pitch) / 10.0;
}

double rounded(double length_mm) {
    return std::round(100.0 * length_mm) / 100.0;
}

/// A kind's keys by what they say, and their lines in a file, lengths and others.
struct WrittenKeys {
    std::vector<std::string> counts, pitches, lengths, wholes, angles, choices;
    std::string length_lines, other_lines;
};

/// Writes what a kind says of its keys (engine/scene/chart/chart_keys.h), as a user wishes them or by default.
class KeyWriter {
  public:
    KeyWriter(const ChartWish& wish, const PrintLayout& layout) : wish_(wish), layout_(layout) {}

    [[nodiscard]] const WrittenKeys& written() const { return written_; }

    void grid(const std::string& key, int& columns, int& rows, const scene::GridKey& says) {
        const auto found = wish_.counts.find(key);
        const scene::GridSize count = found != wish_.counts.end() ? found->second : says.printed;
        columns = count.columns;
        rows = count.rows;
        written_.counts.push_back(key);
        written_.length_lines += fmt::format("{} = [{}, {}]\n", key, columns, rows);
    }
    void pitch(const std::string& key, double& mm, scene::GridSize cells) {
        mm = number(key, fitting_pitch_mm(layout_, cells), written_.pitches, written_.length_lines);
    }
    void length(const std::string& key, double& mm, scene::GridSize cells) {
        mm = number(key, fitting_pitch_mm(layout_, cells), written_.lengths, written_.length_lines);
    }
    void part(const std::string& key, double& mm, const scene::PartKey& says) {
        mm = number(key, rounded(says.printed_mm), written_.lengths, written_.length_lines);
    }
    void whole(const std::string& key, int& value, const scene::WholeKey& says) {
        value = says.printed;
        number(key, says.printed, written_.wholes, written_.other_lines);
    }
    void angle(const std::string& key, double& deg, double /*most_deg*/) {
        deg = number(key, deg, written_.angles, written_.other_lines);
    }
    std::string choice(const std::string& key, const std::vector<std::string>& /*names*/, const std::string& printed) {
        written_.choices.push_back(key);
        written_.other_lines +=
            fmt::format("{} = \"{}\"\n", key, wish_.dictionary.empty() ? printed : wish_.dictionary);
        return {};
    }
    /// Whoever reads the file will.
    void refuse(const std::string& /*key*/, const std::string& /*why*/) const {}

  private:
    double number(const std::string& key, double otherwise, std::vector<std::string>& keys, std::string& lines) {
        const auto found = wish_.numbers.find(key);
        const double value = found != wish_.numbers.end() ? found->second : otherwise;
        keys.push_back(key);
        lines += fmt::format("{} = {}\n", key, value);
        return value;
    }

    const ChartWish& wish_;
    const PrintLayout& layout_;
    WrittenKeys written_;
};

WrittenKeys written_keys(const ChartWish& wish, const PrintLayout& layout) {
    KeyWriter keys(wish, layout);
    of_kind<scene::ChartPattern>(wish.kind, [&](auto& pattern) { visit_keys(pattern, keys); });
    return keys.written();
}

bool contains(const std::vector<std::string>& keys, const std::string& key) {
    return std::ranges::find(keys, key) != keys.end();
}

void add_new(std::vector<std::string>& to, const std::vector<std::string>& keys) {
    for (const std::string& key : keys) {
        if (!contains(to, key)) {
            to.push_back(key);
        }
    }
}

void check_kind(const std::string& name) {
    for (const scene::ChartKind& kind : scene::chart_kinds()) {
        if (kind.name == name && kind.not_printed.empty()) {
            return;
        }
    }
    std::string why;
    for (const scene::ChartKind& kind : scene::chart_kinds()) {
        why += kind.name == name ? fmt::format(" ({})", kind.not_printed) : "";
    }
    throw InputError(fmt::format("a chart of kind {} cannot be printed{}{}", name, why,
                                 complete_name_hint(name, printable_kinds())));
}

/// Refuses what the kind does not have.
void check_keys(const ChartWish& wish, const WrittenKeys& keys) {
    const auto refuse = [&](std::string key) {
        std::ranges::replace(key, '_', '-');
        throw InputError(fmt::format("--{}: a chart of kind {} has none", key, wish.kind));
    };
    for (const auto& [key, count] : wish.counts) {
        if (!contains(keys.counts, key)) {
            refuse(key);
        }
    }
    for (const auto& [key, number] : wish.numbers) {
        if (!contains(keys.pitches, key) && !contains(keys.lengths, key) && !contains(keys.wholes, key) &&
            !contains(keys.angles, key)) {
            refuse(key);
        }
    }
    if (!wish.dictionary.empty() && keys.choices.empty()) {
        refuse("dictionary");
    }
}

}  // namespace

std::vector<std::string> printable_kinds() {
    std::vector<std::string> names;
    for (const scene::ChartKind& kind : scene::chart_kinds()) {
        if (kind.not_printed.empty()) {
            names.push_back(kind.name);
        }
    }
    return names;
}

ChartKeys printable_keys() {
    ChartKeys keys;
    for (const std::string& kind : kind_names<scene::ChartPattern>()) {
        add_new(keys.counts, written_keys({.kind = kind}, {}).counts);
    }
    WrittenKeys all;
    for (const std::string& kind : printable_kinds()) {
        const WrittenKeys own = written_keys({.kind = kind}, {});
        add_new(all.pitches, own.pitches);
        add_new(all.lengths, own.lengths);
        add_new(all.wholes, own.wholes);
        add_new(keys.angles, own.angles);
    }
    for (const auto& of_sort : {all.pitches, all.lengths, all.wholes}) {
        add_new(keys.numbers, of_sort);
    }
    return keys;
}

scene::GridSize parse_grid_size(const std::string& option, const std::string& text) {
    const std::size_t cross = text.find('x');
    scene::GridSize size;
    const char* const middle = text.data() + std::min(cross, text.size());
    const char* const end = text.data() + text.size();
    const auto [after_columns, no_columns] = std::from_chars(text.data(), middle, size.columns);
    const auto [after_rows, no_rows] = std::from_chars(std::min(middle + 1, end), end, size.rows);
    if (cross == std::string::npos || no_columns != std::errc() || no_rows != std::errc() || after_columns != middle ||
        after_rows != end || size.columns < 1 || size.rows < 1) {
        throw InputError(fmt::format("{} {}: expected columns and rows, as in 10x7", option, text));
    }
    return size;
}

std::string chart_toml(const ChartWish& wish, const PrintLayout& layout) {
    check_kind(wish.kind);
    const WrittenKeys keys = written_keys(wish, layout);
    check_keys(wish, keys);
    return fmt::format("[chart]\nkind = \"{}\"\n{}{}", wish.kind, keys.length_lines, keys.other_lines);
}

std::string chart_caption(const std::string& toml) {
    std::string caption = "lensproof";
    std::size_t begin = toml.find('\n') + 1;
    while (begin < toml.size()) {
        const std::size_t end = toml.find('\n', begin);
        caption += "  " + toml.substr(begin, end - begin);
        begin = end + 1;
    }
    return caption;
}

}  // namespace lensproof::draw
