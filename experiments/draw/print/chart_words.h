// experiments/draw/print/chart_words.h — charts to print, from what a user asks for.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/draw/print/chart_print.h"

namespace lensproof::draw {

/// What a user says of a chart, by the keys of its file (the kinds' `visit_keys`); the rest has defaults.
struct ChartWish {
    std::string kind;
    std::map<std::string, scene::GridSize> counts;  // "squares", …
    std::map<std::string, double> numbers;          // "square_mm", …
    std::string dictionary;
};

/// The kinds that can be printed.
std::vector<std::string> printable_kinds();

/// The keys that such kinds may have: for columns and rows, for positive numbers, and for angles.
struct ChartKeys {
    std::vector<std::string> counts, numbers, angles;
};
ChartKeys printable_keys();

/// "10x7". Throws InputError naming `option`.
scene::GridSize parse_grid_size(const std::string& option, const std::string& text);

/// The TOML file's [chart] table. Counts default to what suits the kind, the pitch to the largest whole mm that fits on
/// the page, other lengths to a fraction of the pitch. Throws InputError for a kind that cannot be printed and for a
/// key that the kind does not have.
std::string chart_toml(const ChartWish& wish, const PrintLayout& layout);

/// One line for the foot of the page: the kind and its dimensions.
std::string chart_caption(const std::string& toml);

}  // namespace lensproof::draw
