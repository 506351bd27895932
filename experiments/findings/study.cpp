#include "experiments/findings/study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "experiments/findings/varied.h"

namespace lensproof::findings {

std::vector<TomlTable> ExperimentFile::tables(const std::string& key) {
    std::vector<TomlTable> tables;
    if (top.is_table(key)) {
        tables.push_back(top.table(key));
        return tables;
    }
    for (Varied& one : varied_tables(top, key)) {
        tables.push_back(std::move(one.table));
    }
    return tables;
}

void ExperimentFile::add_subject(const TomlTable& table, const std::string& key, const std::string& id) {
    if (!subjects.insert(id).second) {
        table.fail(key, fmt::format("makes a second subject \"{}\" of the report, expected one of each id", id));
    }
}

std::string read_name(TomlTable& table) {
    std::string name = table.text("name");
    // Names become files' names.
    const bool plain = std::ranges::all_of(
        name, [](unsigned char letter) { return std::isalnum(letter) != 0 || letter == '-' || letter == '_'; });
    if (name.empty() || !plain) {
        table.fail("name", fmt::format("is \"{}\", expected letters, digits, - and _", name));
    }
    return name;
}

std::string name_or(TomlTable& table, const std::string& kind) {
    return table.has("name") ? read_name(table) : kind;
}

Findings told_apart(Findings found, const std::string& name, const std::string& kind) {
    if (name == kind) {
        return found;
    }
    const auto own = [&](std::string& id) { id = id.empty() ? id : name + "-" + id; };
    for (Check& check : found.checks) {
        own(check.id);
        own(check.subject);
        check.group += " (" + name + ")";
    }
    for (Subject& subject : found.subjects) {
        own(subject.id);
        subject.label = name + ": " + subject.label;
        for (Picture& picture : subject.pictures) {
            own(picture.name);
        }
    }
    for (auto& [key, table] : found.tables) {
        Json rows = Json::list();
        for (Json row : table) {
            row["id"] = name + "-" + row["id"].text();
            rows.push_back(std::move(row));
        }
        table = std::move(rows);
    }
    return found;
}

Bound read_bound(TomlTable& table, const Bounds& bounds) {
    const bool is_between = table.has("between");
    if (table.has("at_most") + table.has("at_least") + is_between != 1) {
        table.fail("", "expected one of at_most, at_least and between");
    }
    if (is_between) {
        const std::vector<double> ends = table.numbers("between", 2);
        const Bound bound{Expectation::within, 0.5 * (ends[1] - ends[0]), 0.5 * (ends[0] + ends[1])};
        if (!(bound.limit > 0.0)) {
            table.fail("between", fmt::format("is [{}, {}], expected the lower number first", ends[0], ends[1]));
        }
        return bound;
    }
    const bool is_most = table.has("at_most");
    return {is_most ? Expectation::at_most : Expectation::at_least,
            table.number(is_most ? "at_most" : "at_least", bounds)};
}

std::vector<std::string> names_of(TomlTable& table, const std::string& key, const std::vector<std::string>& known) {
    std::vector<std::string> names = table.has(key) ? table.texts(key) : std::vector<std::string>{};
    for (const std::string& name : names) {
        if (std::ranges::find(known, name) == known.end()) {
            table.fail(key, fmt::format("names \"{}\", expected one of {}", name, fmt::join(known, ", ")));
        }
    }
    return names;
}

}  // namespace lensproof::findings
