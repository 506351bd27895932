// engine/base/toml_text.h — texts as a TOML file states them.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace lensproof {

/// Between quotes. What is not UTF-8 in it is replaced by U+FFFD, since a TOML file may hold nothing else.
std::string toml_string(std::string_view bytes);

/// A list of those.
std::string toml_strings(const std::vector<std::string>& texts);

/// Lines as they are, between triple quotes; a single line in single ones.
std::string toml_paragraph(std::string_view bytes);

/// A key, in quotes where it needs them.
std::string toml_key(const std::string& name);

}  // namespace lensproof
