#include "engine/base/json_value.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "engine/base/input_error.h"
#include "engine/base/text.h"

namespace lensproof {

namespace {

using Json = nlohmann::json;

constexpr int kDeepest = 64;
constexpr std::size_t kLargest = std::size_t{16} << 20U;  // bytes; parsed, a text takes up to thirty times its size

/// Python writes NaN and Infinity, which JSON has not: here they become texts, which `JsonValue::number` reads.
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

JsonValue JsonValue::parse(const std::string& text, const std::filesystem::path& file) {
    const auto bounded = [&](int depth, Json::parse_event_t, Json&) {
        if (depth > kDeepest) {
            throw InputError(fmt::format("{}: more than {} brackets inside one another", file.string(), kDeepest));
        }
        return true;
    };
    if (text.size() > kLargest) {
        throw InputError(fmt::format("{}: {} bytes, expected at most {}", file.string(), text.size(), kLargest));
    }
    try {
        auto root = std::make_shared<const Json>(Json::parse(with_quoted_numbers(text), bounded));
        const Json* json = root.get();
        return {std::move(root), json, file.string() + ": the top"};
    } catch (const Json::parse_error& error) {
        throw InputError(fmt::format("{}: not JSON at byte {}", file.string(), error.byte));
    } catch (const Json::exception&) {
        throw InputError(fmt::format("{}: holds a number or a text that cannot be read", file.string()));
    }
}

void JsonValue::fail(std::string_view expected) const {
    throw InputError(
        fmt::format("{} is {}, expected {}", where_,
                    printable(json_->is_structured() ? json_->type_name()
                                                     : json_->dump(-1, ' ', false, Json::error_handler_t::replace)),
                    expected));
}

bool JsonValue::has(const std::string& key) const {
    return json_->is_object() && json_->contains(key) && !json_->at(key).is_null();
}

JsonValue JsonValue::at(const std::string& key) const {
    if (!json_->is_object() || !json_->contains(key)) {
        throw InputError(fmt::format("{} has no \"{}\", which is expected there", where_, key));
    }
    return {root_, &json_->at(key), fmt::format("{}.{}", where_, key)};
}

std::vector<JsonValue> JsonValue::list() const {
    if (!json_->is_array()) {
        fail("a list");
    }
    std::vector<JsonValue> values;
    for (std::size_t i = 0; i < json_->size(); ++i) {
        values.push_back(JsonValue(root_, &(*json_)[i], fmt::format("{}[{}]", where_, i)));
    }
    return values;
}

double JsonValue::number() const {
    const Json* json = json_;
    while (json->is_array() && json->size() == 1) {
        json = &json->front();
    }
    if (json->is_number()) {
        return json->get<double>();
    }
    const std::optional<double> named =
        json->is_string() ? parse_number(json->get_ref<const std::string&>()) : std::nullopt;
    if (!named) {
        fail("a number");
    }
    return *named;
}

double JsonValue::number_or(const std::string& key, double fallback) const {
    return has(key) ? at(key).number() : fallback;
}

std::string JsonValue::text() const {
    if (!json_->is_string()) {
        fail("a text");
    }
    return json_->get<std::string>();
}

std::string JsonValue::text_or(const std::string& key, const std::string& fallback) const {
    return has(key) ? at(key).text() : fallback;
}

bool JsonValue::is_true(const std::string& key) const {
    return has(key) && json_->at(key).is_boolean() && json_->at(key).get<bool>();
}

bool JsonValue::says(const std::string& key) const {
    return has(key) && json_->at(key) != false && !(json_->at(key).is_structured() && json_->at(key).empty()) &&
           json_->at(key) != "";
}

std::vector<std::string> JsonValue::keys_beside(const std::set<std::string>& known) const {
    std::vector<std::string> keys;
    if (!json_->is_object()) {
        fail("an object");
    }
    for (const auto& [key, value] : json_->items()) {
        if (!known.contains(key)) {
            keys.push_back(key);
        }
    }
    return keys;
}

}  // namespace lensproof
