#include "experiments/findings/study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace lensproof::findings {

void ExperimentFile::add_subject(const TomlTable& table, const std::string& key, const std::string& id) {
    if (!subjects.insert(id).second) {
        table.fail(key, fmt::format("makes a second subject \"{}\" of the report, expected one of each id", id));
    }
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
