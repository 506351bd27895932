#include "experiments/draw/print/chart_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/base/input_error.h"

namespace lensproof::draw {

namespace {

/// A key with its default as a share of the pitch.
struct Share {
    std::string key;
    double of_pitch = 0.0;
};

struct PrintableKind {
    std::string name;
    std::string count_key;  // empty: none
    scene::GridSize count;
    std::string pitch_key;
    std::vector<Share> shares;
};

const std::vector<PrintableKind>& kinds() {
    static const std::vector<PrintableKind> all = {
        {"checkerboard", "squares", {10, 7}, "square_mm", {}},
        {"charuco", "squares", {10, 7}, "square_mm", {{"marker_mm", 0.72}}},
        {"disc-grid", "discs", {10, 7}, "pitch_mm", {{"diameter_mm", 0.5}}},
        {"point-grid", "points", {10, 7}, "pitch_mm", {{"dot_mm", 0.3}}},
        {"slanted-edges", "squares", {7, 5}, "pitch_mm", {{"square_mm", 0.6}}},
        {"straight-lines", "lines", {13, 9}, "pitch_mm", {{"line_mm", 0.06}}},
        {"astigmatism-crosses", "crosses", {9, 7}, "pitch_mm", {{"length_mm", 0.6}, {"line_mm", 0.02}}},
        {"siemens-star", "", {2, 2}, "radius_mm", {}},
        {"flat-field", "", {}, "", {}},
    };
    return all;
}

const PrintableKind& kind_called(const std::string& name) {
    const auto found =
        std::find_if(kinds().begin(), kinds().end(), [&](const auto& kind) { return kind.name == name; });
    if (found == kinds().end()) {
        throw InputError(fmt::format(
            "a chart of kind {} cannot be printed{}: expected one of {}", name,
            name == "colour-checker" ? " (what its patches reflect is measured, and no printer repeats it)" : "",
            fmt::join(printable_kinds(), ", ")));
    }
    return *found;
}

/// Keys without a default that depends on the pitch.
bool takes(const PrintableKind& kind, const std::string& key) {
    return key == kind.pitch_key || (key == "sectors" && kind.name == "siemens-star") ||
           (key == "angle_deg" && kind.name == "slanted-edges") ||
           std::any_of(kind.shares.begin(), kind.shares.end(), [&](const Share& share) { return share.key == key; });
}

[[noreturn]] void refuse(const PrintableKind& kind, std::string key) {
    std::replace(key.begin(), key.end(), '_', '-');
    throw InputError(fmt::format("--{}: a chart of kind {} has none", key, kind.name));
}

void check_keys(const ChartWish& wish, const PrintableKind& kind) {
    for (const auto& [key, count] : wish.counts) {
        if (key != kind.count_key) {
            refuse(kind, key);
        }
    }
    for (const auto& [key, number] : wish.numbers) {
        if (!takes(kind, key)) {
            refuse(kind, key);
        }
    }
    if (!wish.dictionary.empty() && kind.name != "charuco") {
        refuse(kind, "dictionary");
    }
}

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

}  // namespace

std::vector<std::string> printable_kinds() {
    std::vector<std::string> names;
    names.reserve(kinds().size());
    for (const PrintableKind& kind : kinds()) {
        names.push_back(kind.name);
    }
    return names;
}

std::vector<std::string> count_keys() {
    return {"squares", "discs", "points", "crosses", "lines"};
}

std::vector<std::string> number_keys() {
    return {"square_mm", "pitch_mm",  "marker_mm", "diameter_mm", "dot_mm",
            "line_mm",   "length_mm", "radius_mm", "sectors",     "angle_deg"};
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
    const PrintableKind& kind = kind_called(wish.kind);
    check_keys(wish, kind);
    std::string toml = fmt::format("[chart]\nkind = \"{}\"\n", kind.name);
    const scene::GridSize count = wish.counts.count(kind.count_key) != 0 ? wish.counts.at(kind.count_key) : kind.count;
    if (!kind.count_key.empty()) {
        toml += fmt::format("{} = [{}, {}]\n", kind.count_key, count.columns, count.rows);
    }
    const auto wished = [&](const std::string& key, double otherwise) {
        const auto found = wish.numbers.find(key);
        return found != wish.numbers.end() ? found->second : otherwise;
    };
    double pitch_mm = 0.0;
    if (!kind.pitch_key.empty()) {
        pitch_mm = wished(kind.pitch_key, fitting_pitch_mm(layout, count));
        toml += fmt::format("{} = {}\n", kind.pitch_key, pitch_mm);
    }
    for (const Share& share : kind.shares) {
        toml += fmt::format("{} = {}\n", share.key, wished(share.key, rounded(share.of_pitch * pitch_mm)));
    }
    if (kind.name == "charuco") {
        const int needed = count.columns * count.rows / 2;
        const int size = needed <= 50 ? 50 : (needed <= 100 ? 100 : 250);
        toml += fmt::format("dictionary = \"{}\"\n",
                            wish.dictionary.empty() ? fmt::format("DICT_5X5_{}", size) : wish.dictionary);
    }
    if (kind.name == "siemens-star") {
        toml += fmt::format("sectors = {}\n", wished("sectors", 72.0));
    }
    if (kind.name == "slanted-edges") {
        toml += fmt::format("angle_deg = {}\n", wished("angle_deg", 5.0));
    }
    return toml;
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
