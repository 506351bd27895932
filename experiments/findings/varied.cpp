#include "experiments/findings/varied.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <iterator>

#include "engine/base/toml_text.h"

namespace lensproof::findings {

namespace {

constexpr std::size_t kMostTables = 1000;

/// All lists, texts, numbers and ranges in the table and in those below it.
void collect(TomlTable table, const std::string& path, std::vector<Axis>& axes) {
    for (const std::string& key : table.keys()) {
        const bool is_plain = std::ranges::all_of(
            key, [](unsigned char letter) { return std::isalnum(letter) != 0 || letter == '_' || letter == '-'; });
        if (key.empty() || !is_plain) {
            table.fail(key, "expected a key of letters, digits, - and _");
        }
        if (path.empty() && (key == "name" || key == "vary")) {
            table.fail(key, "follows from the others");
        }
        if (table.is_table(key) && !table.table(key).has("from")) {
            collect(table.table(key), path + key + ".", axes);
            continue;
        }
        axes.push_back(table.is_text(key) || table.is_text_list(key) ? read_text_axis(table, key)
                                                                     : read_number_axis(table, key));
        axes.back().key = path + key;
    }
}

/// A part of a file's name.
std::string plain_name(std::string text) {
    std::ranges::replace_if(
        text, [](unsigned char letter) { return std::isalnum(letter) == 0 && letter != '_' && letter != '-'; }, '_');
    return text;
}

/// "4-brown-conrady"
std::string name_of(const std::vector<Axis>& at) {
    std::vector<std::string> parts;
    std::ranges::transform(at, std::back_inserter(parts), [](const Axis& axis) {
        return plain_name(axis.is_text() ? axis.label(0) : fmt::format("{:g}", axis.numbers.front()));
    });
    return fmt::format("{}", fmt::join(parts, "-"));
}

/// What is put over the table, written at the line where it was asked for.
TomlTable stated(TomlTable& table, const std::vector<Axis>& at) {
    std::vector<std::string> values;
    if (table.has("name")) {
        values.push_back(fmt::format("name = {}", toml_string(fmt::format("{}-{}", table.text("name"), name_of(at)))));
    }
    if (table.has("title") && axis_named(at, "title") == nullptr) {
        values.push_back(
            fmt::format("title = {}", toml_string(fmt::format("{}: {}", table.text("title"), words_of(at)))));
    }
    for (const Axis& axis : at) {
        values.push_back(
            fmt::format("{} = {}", axis.key,
                        axis.is_text() ? toml_string(axis.texts.front()) : fmt::format("{}", axis.numbers.front())));
    }
    const std::string above(static_cast<std::size_t>(table.line("vary") - 1), '\n');
    return TomlTable::parse(fmt::format("{}vary = {{ {} }}\n", above, fmt::join(values, ", ")), table.file())
        .table("vary");
}

void add_varied(TomlTable& table, std::vector<Varied>& made) {
    std::vector<Axis> axes;
    collect(table.table("vary"), "", axes);
    const std::size_t count = combinations(axes);
    if (axes.empty() || count > kMostTables) {
        table.fail("vary", fmt::format("makes {} tables, expected 1 to {}", axes.empty() ? 0 : count, kMostTables));
    }
    for (std::size_t i = 0; i < count; ++i) {
        const std::vector<std::size_t> place = place_of(axes, i);
        std::vector<Axis> at;
        for (std::size_t a = 0; a < axes.size(); ++a) {
            Axis& one = at.emplace_back(Axis{.key = axes[a].key});
            if (axes[a].is_text()) {
                one.texts = {axes[a].texts[place[a]]};
            } else {
                one.numbers = {axes[a].numbers[place[a]]};
            }
        }
        TomlTable whole = table.overlaid(stated(table, at));
        whole.table("vary");  // is read
        made.push_back({std::move(whole), std::move(at)});
    }
}

}  // namespace

std::string words_of(const std::vector<Axis>& at) {
    std::vector<std::string> labels;
    std::ranges::transform(at, std::back_inserter(labels), [](const Axis& axis) { return axis.label(0); });
    return fmt::format("{}", fmt::join(labels, ", "));
}

std::vector<Varied> varied_tables(TomlTable& owner, const std::string& key) {
    std::vector<Varied> made;
    for (TomlTable& table : owner.tables(key)) {
        if (table.has("vary")) {
            add_varied(table, made);
        } else {
            made.push_back({std::move(table)});
        }
    }
    return made;
}

}  // namespace lensproof::findings
