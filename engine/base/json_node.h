// engine/base/json_node.h — a JSON file read key by key, so that every complaint names the file and the key.
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/input_error.h"
#include "engine/base/json.h"
#include "engine/base/vec.h"

namespace lensproof {

/// A value of a JSON file, and the keys that lead to it ("curves.x.value[3]"). What is asked for and is not there is an
/// InputError "file: key is X: expected Y". The file's values live as long as the last of their nodes.
class JsonNode {
  public:
    /// The file's top. Throws as Json::parse.
    static JsonNode parse(std::string_view text, const std::string& file);

    [[nodiscard]] const Json& value() const { return *value_; }
    [[nodiscard]] std::string where() const;  // "file: key"
    [[nodiscard]] InputError error(std::string_view expected) const;

    /// Whether the key is there, and not null.
    [[nodiscard]] bool has(const std::string& key) const { return !(*value_)[key].is_null(); }
    [[nodiscard]] JsonNode at(const std::string& key) const;
    [[nodiscard]] double number() const;  // finite
    [[nodiscard]] int count() const;
    [[nodiscard]] std::string text() const;
    [[nodiscard]] bool truth() const;
    [[nodiscard]] std::vector<JsonNode> elements() const;
    [[nodiscard]] std::vector<double> numbers() const;
    [[nodiscard]] std::vector<double> numbers(std::size_t count) const;
    [[nodiscard]] Vec2d pair() const;
    [[nodiscard]] Vec3d triple() const;
    [[nodiscard]] std::vector<std::string> keys() const;

  private:
    JsonNode(std::shared_ptr<const Json> value, std::shared_ptr<const std::string> file, std::string key)
        : value_(std::move(value)), file_(std::move(file)), key_(std::move(key)) {}
    [[nodiscard]] JsonNode child(const Json& value, std::string key) const;

    std::shared_ptr<const Json> value_;  // shares the whole file's
    std::shared_ptr<const std::string> file_;
    std::string key_;
};

}  // namespace lensproof
