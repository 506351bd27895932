// engine/formats/prescription/python_json.h — JSON as Python's json module writes it, and as its users fill it.
#pragma once
#include <set>
#include <string>
#include <vector>

#include "engine/base/json_node.h"

namespace lensproof::formats {

/// Throws InputError as JsonNode::parse does, and for more than 16 MiB.
JsonNode parse_python_json(const std::string& text, const std::string& file);

/// A number; NaN, Infinity and -Infinity are some, which Python writes as they stand here. Also the one number in a
/// list, which is how arrays of one are saved.
double any_number(const JsonNode& node);

/// What stands under the key; the fallback where nothing does.
double number_or(const JsonNode& node, const std::string& key, double fallback);
std::string text_or(const JsonNode& node, const std::string& key, const std::string& fallback);
bool is_true(const JsonNode& node, const std::string& key);

/// Whether something stands there: not null, false, nor an empty list, object or text.
bool says(const JsonNode& node, const std::string& key);

/// The keys that are not in `known`, sorted.
std::vector<std::string> keys_beside(const JsonNode& node, const std::set<std::string>& known);

}  // namespace lensproof::formats
