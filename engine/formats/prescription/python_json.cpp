#include "engine/formats/prescription/python_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "engine/base/text.h"

namespace lensproof::formats {

namespace {

constexpr std::size_t kLargest = std::size_t{16} << 20U;  // bytes; parsed, a text takes up to thirty times its size

/// NaN and Infinity, which JSON has not, as texts, which `any_number` reads.
std::string with_quoted_numbers(const std::string& text) {
    std::string json;
    json.reserve(text.size() + 64);
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const std::string_view rest = std::string_view(text).substr(i);
        if (quoted && text[i] == '\\' && i + 1 < text.size()) {
            json += text[i++];
        } else if (text[i] == '"') {
            quoted = !quoted;
        } else if (!quoted) {
            std::size_t size = 0;
            for (const std::string_view name : {"-Infinity", "Infinity", "NaN"}) {
                size = size == 0 && rest.starts_with(name) ? name.size() : size;
            }
            if (size > 0) {
                json += fmt::format("\"{}\"", rest.substr(0, size));
                i += size - 1;
                continue;
            }
        }
        json += text[i];
    }
    return json;
}

}  // namespace

JsonNode parse_python_json(const std::string& text, const std::string& file) {
    if (text.size() > kLargest) {
        throw InputError(fmt::format("{}: {} bytes, expected at most {}", file, text.size(), kLargest));
    }
    return JsonNode::parse(with_quoted_numbers(text), file);
}

double any_number(const JsonNode& node) {
    const Json* json = &node.value();
    while (json->is_list() && json->size() == 1) {
        json = &(*json)[0];
    }
    if (json->is_number()) {
        return json->number();
    }
    const std::optional<double> named = json->is_text() ? parse_number(json->text()) : std::nullopt;
    if (!named) {
        throw node.error("a number");
    }
    return *named;
}

double number_or(const JsonNode& node, const std::string& key, double fallback) {
    return node.has(key) ? any_number(node.at(key)) : fallback;
}

std::string text_or(const JsonNode& node, const std::string& key, const std::string& fallback) {
    return node.has(key) ? node.at(key).text() : fallback;
}

bool is_true(const JsonNode& node, const std::string& key) {
    return node.value()[key] == Json(true);
}

bool says(const JsonNode& node, const std::string& key) {
    const Json& value = node.value()[key];
    const bool is_empty = (value.is_list() || value.is_object()) && value.empty();
    return !value.is_null() && !is_empty && !(value == Json(false)) && !(value == Json(""));
}

std::vector<std::string> keys_beside(const JsonNode& node, const std::set<std::string>& known) {
    std::vector<std::string> keys = node.keys();
    std::erase_if(keys, [&](const std::string& key) { return known.contains(key); });
    std::ranges::sort(keys);
    return keys;
}

}  // namespace lensproof::formats
