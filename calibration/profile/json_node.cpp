#include "calibration/profile/json_node.h"

#include <cmath>

namespace lensproof::calibration {

InputError JsonNode::error(const std::string& expected) const {
    std::string found = value_->dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    if (found.size() > 60) {
        found = std::string(value_->type_name()) + " of " + std::to_string(value_->size()) + " values";
    }
    return InputError(file_ + ": " + (key_.empty() ? "the file" : key_) + " is " + found + ": expected " + expected);
}

JsonNode JsonNode::at(const std::string& key) const {
    if (!value_->is_object()) {
        throw error("an object");
    }
    const std::string path = key_.empty() ? key : key_ + "." + key;
    const auto found = value_->find(key);
    if (found == value_->end()) {
        throw InputError(file_ + ": " + path + " is missing: expected in a lensproof-profile/1 file");
    }
    return {*found, file_, path};
}

double JsonNode::number() const {
    if (!value_->is_number() || !std::isfinite(value_->get<double>())) {
        throw error("a finite number");
    }
    return value_->get<double>();
}

int JsonNode::count() const {
    if (!value_->is_number_integer() || value_->get<double>() < 0.0 || value_->get<double>() > 2e9) {
        throw error("a count");
    }
    return value_->get<int>();
}

std::string JsonNode::text() const {
    if (!value_->is_string()) {
        throw error("a text");
    }
    return value_->get<std::string>();
}

bool JsonNode::truth() const {
    if (!value_->is_boolean()) {
        throw error("true or false");
    }
    return value_->get<bool>();
}

std::vector<JsonNode> JsonNode::elements() const {
    if (!value_->is_array()) {
        throw error("a list");
    }
    std::vector<JsonNode> nodes;
    nodes.reserve(value_->size());
    for (std::size_t i = 0; i < value_->size(); ++i) {
        nodes.emplace_back((*value_)[i], file_, key_ + "[" + std::to_string(i) + "]");
    }
    return nodes;
}

std::vector<double> JsonNode::numbers() const {
    std::vector<double> result;
    for (const JsonNode& node : elements()) {
        result.push_back(node.number());
    }
    return result;
}

std::vector<double> JsonNode::numbers(std::size_t count) const {
    std::vector<double> result = numbers();
    if (result.size() != count) {
        throw error("a list of " + std::to_string(count) + " numbers");
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

std::vector<std::string> JsonNode::texts() const {
    std::vector<std::string> result;
    for (const JsonNode& node : elements()) {
        result.push_back(node.text());
    }
    return result;
}

std::vector<std::string> JsonNode::keys() const {
    if (!value_->is_object()) {
        throw error("an object");
    }
    std::vector<std::string> result;
    for (const auto& item : value_->items()) {
        result.push_back(item.key());
    }
    return result;
}

}  // namespace lensproof::calibration
