#include "engine/base/toml.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/nearest_name.h"

namespace lensproof {

namespace {

std::string shown(const toml::node& node) {
    if (const std::optional<double> number = node.value_exact<double>()) {
        return fmt::format("{}", *number);  // the shortest that reads back, not seventeen digits
    }
    std::ostringstream stream;
    node.visit([&](const auto& value) { stream << value; });
    return stream.str();
}

/// Past the text in quotes at `at`, on its own line or, between three quotes, on several; one quote or two may stand
/// before the closing three.
std::size_t past_quotes(std::string_view text, std::size_t at) {
    const char quote = text[at];
    const std::string three(3, quote);
    const bool is_long = text.substr(at, 3) == three;
    for (at += is_long ? 3 : 1; at < text.size(); ++at) {
        if (text[at] == '\\' && quote == '"') {
            ++at;
        } else if (is_long ? text.substr(at, 3) == three : text[at] == quote) {
            at += is_long ? 3 : 1;
            break;
        } else if (text[at] == '\n' && !is_long) {
            break;
        }
    }
    while (is_long && at < text.size() && text[at] == quote) {
        ++at;
    }
    return std::min(at, text.size());
}

/// Refuses keys of many parts, a.b.c…: each is a table in the one before, and the library calls itself for each. It
/// bounds brackets itself, to 256, so that nothing lies more than 257 · 32 deep, which a stack of 1 MiB holds.
void check_keys(std::string_view text, const std::filesystem::path& name) {
    constexpr std::size_t kMostParts = 32;
    std::size_t parts = 1;
    for (std::size_t at = 0; at < text.size();) {
        const char c = text[at];
        if (c == '"' || c == '\'') {
            at = past_quotes(text, at);
            continue;
        }
        if (c == '#') {
            at = std::min(text.find('\n', at), text.size());
            continue;
        }
        if (c == '.') {
            ++parts;
        } else if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) {
            parts = 1;
        }
        if (parts > kMostParts) {
            throw InputError(fmt::format(
                "{}:{}: a key of more than {} parts", name.string(),
                1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'), kMostParts));
        }
        ++at;
    }
}

/// Puts `over` over `under`, as TomlTable::overlaid says.
void put_over(toml::table& under, const toml::table& over) {
    for (const auto& [key, node] : over) {
        toml::table* inner = under[key].as_table();
        if (inner != nullptr && node.is_table()) {
            put_over(*inner, *node.as_table());
        } else {
            under.insert_or_assign(key, node);
        }
    }
}

}  // namespace

std::string TomlTable::Layer::qualified(const std::string& key) const {
    return path.empty() || key.empty() ? path + key : path + "." + key;
}

TomlTable::Layer TomlTable::Layer::below(const std::string& key, const toml::table* inner) const {
    return {root, inner, file, qualified(key)};
}

TomlTable TomlTable::read(const std::filesystem::path& file) {
    return parse(read_file(file), file);
}

TomlTable TomlTable::parse(const std::string& text, const std::filesystem::path& name) {
    check_keys(text, name);
    try {
        auto root = std::make_shared<const toml::table>(toml::parse(text));
        const toml::table* top = root.get();
        return TomlTable({{std::move(root), top, name, ""}});
    } catch (const toml::parse_error& error) {
        throw InputError(fmt::format("{}:{}: not TOML: {}", name.string(), error.source().begin.line,
                                     std::string(error.description())));
    }
}

TomlTable TomlTable::overlaid(const TomlTable& over) const {
    std::vector<Layer> layers = over.layers_;
    layers.insert(layers.end(), layers_.begin(), layers_.end());
    return TomlTable(std::move(layers));
}

const TomlTable::Layer& TomlTable::layer_of(const std::string& key) const {
    const auto found = std::ranges::find_if(layers_, [&](const Layer& layer) { return layer.table->contains(key); });
    return found == layers_.end() ? layers_.back() : *found;
}

const toml::node* TomlTable::get(const std::string& key) const {
    return layer_of(key).table->get(key);
}

bool TomlTable::has(const std::string& key) const {
    asked_after_.insert(key);
    return get(key) != nullptr;
}

std::vector<std::string> TomlTable::keys() const {
    std::set<std::string> names;
    for (const Layer& layer : layers_) {
        for (const auto& [key, node] : *layer.table) {
            names.emplace(key.str());
        }
    }
    return {names.begin(), names.end()};
}

std::vector<std::string> TomlTable::keys_not_taken() const {
    std::vector<std::string> names = keys();
    std::erase_if(names, [&](const std::string& name) { return taken_.contains(name); });
    return names;
}

std::string TomlTable::stated() const {
    toml::table joined;
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
        put_over(joined, *layer->table);
    }
    std::ostringstream text;
    text << toml::json_formatter(joined);
    return text.str();
}

bool TomlTable::is_number(const std::string& key) const {
    const toml::node* node = get(key);
    return node != nullptr && node->is_number();
}

bool TomlTable::is_text(const std::string& key) const {
    const toml::node* node = get(key);
    return node != nullptr && node->is_string();
}

bool TomlTable::is_text_list(const std::string& key) const {
    const toml::node* node = get(key);
    const toml::array* array = node == nullptr ? nullptr : node->as_array();
    return array != nullptr && array->is_homogeneous<std::string>();
}

bool TomlTable::is_table(const std::string& key) const {
    const toml::node* node = get(key);
    return node != nullptr && node->is_table();
}

int TomlTable::line(const std::string& key) const {
    const Layer& layer = layer_of(key);
    const toml::node* node = layer.table->get(key);
    return std::max(1, static_cast<int>((node != nullptr ? node->source() : layer.table->source()).begin.line));
}

std::string TomlTable::where(const std::string& key) const {
    const Layer& layer = layer_of(key);
    const std::string name = layer.qualified(key);
    return fmt::format("{}:{}:{}{}", layer.file.string(), line(key), name.empty() ? "" : " ", name);
}

void TomlTable::fail(const std::string& key, const std::string& message) const {
    throw InputError(fmt::format("{}: {}", where(key), message));
}

const toml::node* TomlTable::find(const std::string& key) {
    taken_.insert(key);
    return get(key);
}

const toml::node& TomlTable::require(const std::string& key) {
    const toml::node* node = find(key);
    if (node == nullptr) {
        fail(key, "is missing" + missing_name_hint(key, keys_not_taken()));
    }
    return *node;
}

double TomlTable::checked_number(const toml::node& node, const std::string& key, const Bounds& bounds) const {
    const std::optional<double> value = node.value<double>();
    if (!value || !node.is_number() || !bounds.hold(*value)) {
        fail(key, fmt::format("is {}, expected {}", shown(node), bounds.expectation()));
    }
    return *value;
}

double TomlTable::number(const std::string& key, const Bounds& bounds) {
    return checked_number(require(key), key, bounds);
}

double TomlTable::number_or(const std::string& key, double fallback, const Bounds& bounds) {
    return optional_number(key, bounds).value_or(fallback);
}

std::optional<double> TomlTable::optional_number(const std::string& key, const Bounds& bounds) {
    const toml::node* node = find(key);
    return node == nullptr ? std::nullopt : std::optional(checked_number(*node, key, bounds));
}

double TomlTable::any_number(const std::string& key) {
    const toml::node& node = require(key);
    const std::optional<double> value = node.value<double>();
    if (!value || !node.is_number()) {
        fail(key, fmt::format("is {}, expected a number", shown(node)));
    }
    return *value;
}

int TomlTable::infinity(const std::string& key) {
    const double value = require(key).value<double>().value_or(0.0);
    return std::isinf(value) ? (value > 0.0 ? 1 : -1) : 0;
}

int TomlTable::integer(const std::string& key, int min, int max) {
    const toml::node& node = require(key);
    const std::optional<std::int64_t> value = node.value_exact<std::int64_t>();
    if (!value || *value < min || *value > max) {
        fail(key, fmt::format("is {}, expected a whole number from {} to {}", shown(node), min, max));
    }
    return static_cast<int>(*value);
}

int TomlTable::integer_or(const std::string& key, int fallback, int min, int max) {
    return has(key) ? integer(key, min, max) : fallback;
}

bool TomlTable::boolean_or(const std::string& key, bool fallback) {
    const toml::node* node = find(key);
    if (node == nullptr) {
        return fallback;
    }
    const std::optional<bool> value = node->value_exact<bool>();
    if (!value) {
        fail(key, fmt::format("is {}, expected true or false", shown(*node)));
    }
    return *value;
}

std::string TomlTable::text(const std::string& key) {
    const toml::node& node = require(key);
    const std::optional<std::string> value = node.value_exact<std::string>();
    if (!value) {
        fail(key, fmt::format("is {}, expected a text in quotes", shown(node)));
    }
    return *value;
}

std::string TomlTable::text_or(const std::string& key, const std::string& fallback) {
    taken_.insert(key);
    return has(key) ? text(key) : fallback;
}

std::string TomlTable::choice(const std::string& key, const std::vector<std::string>& choices) {
    std::string value = text(key);
    if (std::find(choices.begin(), choices.end(), value) == choices.end()) {
        fail(key, fmt::format("is \"{}\", expected one of: {}", value, fmt::join(choices, ", ")));
    }
    return value;
}

std::vector<double> TomlTable::numbers(const std::string& key, std::size_t count, const Bounds& bounds) {
    const toml::node& node = require(key);
    const toml::array* array = node.as_array();
    if (array == nullptr || (count != 0 && array->size() != count)) {
        fail(key, fmt::format("is {}, expected {} numbers in brackets", shown(node),
                              count == 0 ? std::string("some") : std::to_string(count)));
    }
    std::vector<double> values;
    for (const toml::node& element : *array) {
        values.push_back(checked_number(element, key, bounds));
    }
    return values;
}

std::vector<double> TomlTable::any_numbers(const std::string& key) {
    const toml::node& node = require(key);
    std::vector<double> values;
    if (const toml::array* array = node.as_array()) {
        for (const toml::node& element : *array) {
            if (const std::optional<double> value = element.value<double>(); value && element.is_number()) {
                values.push_back(*value);
            }
        }
        if (values.size() == array->size()) {
            return values;
        }
    }
    fail(key, fmt::format("is {}, expected some numbers in brackets", shown(node)));
}

std::vector<std::vector<double>> TomlTable::number_lists(const std::string& key) {
    const toml::node& node = require(key);
    const toml::array* array = node.as_array();
    if (array == nullptr) {
        fail(key, fmt::format("is {}, expected lists of numbers in brackets", shown(node)));
    }
    std::vector<std::vector<double>> lists;
    for (const toml::node& inner : *array) {
        const toml::array* list = inner.as_array();
        if (list == nullptr) {
            fail(key, fmt::format("holds {}, expected a list of numbers", shown(inner)));
        }
        lists.emplace_back();
        for (const toml::node& element : *list) {
            lists.back().push_back(checked_number(element, key, kAnyNumber));
        }
    }
    return lists;
}

std::vector<std::string> TomlTable::texts(const std::string& key) {
    const toml::node& node = require(key);
    const toml::array* array = node.as_array();
    std::vector<std::string> values;
    if (array != nullptr) {
        for (const toml::node& element : *array) {
            if (const auto value = element.value_exact<std::string>()) {
                values.push_back(*value);
            }
        }
    }
    if (array == nullptr || values.size() != array->size()) {
        fail(key, fmt::format("is {}, expected texts in brackets", shown(node)));
    }
    return values;
}

TomlTable TomlTable::table(const std::string& key) {
    const toml::node& node = require(key);
    if (!node.is_table()) {
        fail(key, fmt::format("is {}, expected a table", shown(node)));
    }
    std::vector<Layer> layers;
    for (const Layer& layer : layers_) {
        if (const toml::table* inner = (*layer.table)[key].as_table()) {
            layers.push_back(layer.below(key, inner));
        }
    }
    return TomlTable(std::move(layers));
}

std::optional<TomlTable> TomlTable::optional_table(const std::string& key) {
    taken_.insert(key);
    return has(key) ? std::optional(table(key)) : std::nullopt;
}

std::vector<TomlTable> TomlTable::tables(const std::string& key) {
    std::vector<TomlTable> found;
    const toml::node* node = find(key);
    if (node == nullptr) {
        return found;
    }
    const toml::array* array = node->as_array();
    if (array == nullptr) {
        fail(key, "expected an array of tables");
    }
    for (std::size_t i = 0; i < array->size(); ++i) {
        const toml::table* element = array->get(i)->as_table();
        if (element == nullptr) {
            fail(key, fmt::format("its entry {} is {}, expected a table", i + 1, shown(*array->get(i))));
        }
        found.push_back(TomlTable({layer_of(key).below(fmt::format("{}[{}]", key, i + 1), element)}));
    }
    return found;
}

void TomlTable::finish() const {
    if (const std::vector<std::string> unknown = keys_not_taken(); !unknown.empty()) {
        std::vector<std::string> known;
        std::ranges::set_union(taken_, asked_after_, std::back_inserter(known));
        std::erase(known, unknown.front());  // asked after, but of no use here
        fail(unknown.front(), "is not a key that is known here" + complete_name_hint(unknown.front(), known));
    }
}

}  // namespace lensproof
