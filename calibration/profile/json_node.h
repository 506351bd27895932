// calibration/profile/json_node.h — reading a JSON file with messages that say where it is wrong.
#pragma once
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/input_error.h"
#include "engine/base/vec.h"

namespace lensproof::calibration {

/// A value of a JSON document, the file's name and the way from the document's root to the value ("curves.x.value[3]").
/// What is asked for and not there is an InputError with all three, what was found and what is expected.
/// The document has to live as long as its nodes.
class JsonNode {
  public:
    JsonNode(const nlohmann::ordered_json& value, std::string file, std::string key)
        : value_(&value), file_(std::move(file)), key_(std::move(key)) {}

    [[nodiscard]] InputError error(const std::string& expected) const;
    [[nodiscard]] bool has(const std::string& key) const { return value_->is_object() && value_->contains(key); }
    [[nodiscard]] bool is_null() const { return value_->is_null(); }
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
    [[nodiscard]] std::vector<std::string> texts() const;
    [[nodiscard]] std::vector<std::string> keys() const;

  private:
    const nlohmann::ordered_json* value_;
    std::string file_;
    std::string key_;
};

}  // namespace lensproof::calibration
