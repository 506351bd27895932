// engine/base/json_value.h — a value in a JSON file, asked for by key, so that every complaint names the way to it.
#pragma once
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace lensproof {

/// A value of a parsed file, which lives as long as the last of its values. Members throw InputError
/// "file: the way to it is X, expected Y".
class JsonValue {
  public:
    /// Reads a text as Python's json module writes it: NaN, Infinity and -Infinity are numbers there. Throws InputError
    /// naming `file` for what is no JSON, or nests more than 64 deep, or has more than 16 MiB.
    static JsonValue parse(const std::string& text, const std::filesystem::path& file);

    [[nodiscard]] bool has(const std::string& key) const;  // and it is not null
    [[nodiscard]] JsonValue at(const std::string& key) const;
    [[nodiscard]] std::vector<JsonValue> list() const;
    /// A number, NaN and infinities included; also the one number in a list, which is how arrays of one are saved.
    [[nodiscard]] double number() const;
    [[nodiscard]] double number_or(const std::string& key, double fallback) const;
    [[nodiscard]] std::string text() const;
    [[nodiscard]] std::string text_or(const std::string& key, const std::string& fallback) const;
    [[nodiscard]] bool is_true(const std::string& key) const;
    /// Whether something stands there: not null, false, nor an empty list, object or text.
    [[nodiscard]] bool says(const std::string& key) const;
    /// The keys that are not in `known`.
    [[nodiscard]] std::vector<std::string> keys_beside(const std::set<std::string>& known) const;

    [[nodiscard]] const std::string& where() const { return where_; }
    [[noreturn]] void fail(std::string_view expected) const;

  private:
    JsonValue(std::shared_ptr<const nlohmann::json> root, const nlohmann::json* json, std::string where)
        : root_(std::move(root)), json_(json), where_(std::move(where)) {}

    std::shared_ptr<const nlohmann::json> root_;
    const nlohmann::json* json_;
    std::string where_;
};

}  // namespace lensproof
