#include "engine/base/json_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "engine/base/text.h"

namespace lensproof {

JsonNode JsonNode::parse(std::string_view text, const std::string& file) {
    return {std::make_shared<const Json>(Json::parse(text, file)), std::make_shared<const std::string>(file), ""};
}

std::string JsonNode::where() const {
    return fmt::format("{}: {}", *file_, key_.empty() ? "the file" : key_);
}

InputError JsonNode::error(std::string_view expected) const {
    constexpr std::size_t kMostShown = 60;
    std::string found = value_->dump();
    if (found.size() > kMostShown) {
        found = value_->is_text()
                    ? "a text of " + std::to_string(found.size() - 2) + " bytes"
                    : fmt::format("{} of {} values", value_->is_list() ? "a list" : "an object", value_->size());
    }
    return InputError(fmt::format("{} is {}: expected {}", where(), printable(found), expected));
}

JsonNode JsonNode::child(const Json& value, std::string key) const {
    return {std::shared_ptr<const Json>(value_, &value), file_, std::move(key)};
}

JsonNode JsonNode::at(const std::string& key) const {
    if (!value_->is_object()) {
        throw error(fmt::format("an object with \"{}\"", key));
    }
    std::string path = key_.empty() ? key : key_ + "." + key;
    if (!value_->contains(key)) {
        throw InputError(fmt::format("{}: {} is missing, and expected there", *file_, path));
    }
    return child((*value_)[key], std::move(path));
}

double JsonNode::number() const {
    if (!value_->is_number()) {
        throw error("a finite number");
    }
    return value_->number();
}

int JsonNode::count() const {
    if (!value_->is_whole() || value_->number() < 0.0 || value_->number() > 2e9) {
        throw error("a count");
    }
    return static_cast<int>(value_->number());
}

std::string JsonNode::text() const {
    if (!value_->is_text()) {
        throw error("a text");
    }
    return value_->text();
}

bool JsonNode::truth() const {
    if (!value_->is_truth()) {
        throw error("true or false");
    }
    return value_->truth();
}

std::vector<JsonNode> JsonNode::elements() const {
    if (!value_->is_list()) {
        throw error("a list");
    }
    std::vector<JsonNode> nodes;
    nodes.reserve(value_->size());
    for (std::size_t i = 0; i < value_->size(); ++i) {
        nodes.push_back(child((*value_)[i], fmt::format("{}[{}]", key_, i)));
    }
    return nodes;
}

std::vector<double> JsonNode::numbers() const {
    std::vector<double> numbers;
    std::ranges::transform(elements(), std::back_inserter(numbers), &JsonNode::number);
    return numbers;
}

std::vector<double> JsonNode::numbers(std::size_t count) const {
    std::vector<double> result = numbers();
    if (result.size() != count) {
        throw error(fmt::format("a list of {} numbers", count));
    }
    return result;
}

Vec2d JsonNode::pair() const {
    const auto v = numbers(2);
    return {v[0], v[1]};
}

Vec3d JsonNode::triple() const {
    const auto v = numbers(3);
    return {v[0], v[1], v[2]};
}

std::vector<std::string> JsonNode::keys() const {
    if (!value_->is_object()) {
        throw error("an object");
    }
    std::vector<std::string> keys;
    std::ranges::transform(value_->members(), std::back_inserter(keys), &Json::Members::value_type::first);
    return keys;
}

}  // namespace lensproof
