#include "engine/base/toml_keys.h"

#include <fmt/format.h>

#include <vector>

#include "engine/base/affine.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/nearest_name.h"
#include "engine/base/text.h"

namespace lensproof {

namespace {

constexpr Bounds kCoordinate{.min = -1e12, .max = 1e12};

}  // namespace

std::string NameIndex::add(TomlTable& table, const std::string& key, std::size_t index, bool may_be_empty) {
    std::string name = may_be_empty ? table.text_or(key, "") : table.text(key);
    if (name.empty()) {
        if (!may_be_empty || table.has(key)) {
            table.fail(key, "is empty, expected a name");
        }
        return name;
    }
    if (!index_.try_emplace(name, index).second) {
        table.fail(key, fmt::format("\"{}\" names another {} already", printable(name), what_));
    }
    return name;
}

std::size_t NameIndex::find(TomlTable& table, const std::string& key) const {
    return find(table, key, table.text(key));
}

std::size_t NameIndex::find(const TomlTable& table, const std::string& key, const std::string& name) const {
    const auto found = index_.find(name);
    if (found == index_.end()) {
        std::vector<std::string> known;
        for (const auto& entry : index_) {
            known.push_back(entry.first);
        }
        table.fail(key, fmt::format("is \"{}\", which names no {}{}", printable(name), what_,
                                    known.empty() ? ": there is none" : " here" + name_hint(name, known)));
    }
    return found->second;
}

Vec3d read_vector(TomlTable& table, const std::string& key) {
    const std::vector<double> v = table.numbers(key, 3, kCoordinate);
    return {v[0], v[1], v[2]};
}

Vec3d read_direction(TomlTable& table, const std::string& key) {
    const Vec3d v = read_vector(table, key);
    if (!(largest_coordinate(v) > 1e-12)) {
        table.fail(key, "has no length, expected a direction");
    }
    return normalized(v);
}

std::filesystem::path read_file_name(TomlTable& table, const std::string& key) {
    return file_beside(table, key, table.text(key));
}

std::filesystem::path file_beside(const TomlTable& table, const std::string& key, const std::string& name) {
    std::filesystem::path file = referred_file(table.file(), name);
    try {
        check_readable(file);
    } catch (const InputError& error) {
        table.fail(key, fmt::format("is \"{}\": {}", printable(name), error.what()));
    }
    return file;
}

}  // namespace lensproof
