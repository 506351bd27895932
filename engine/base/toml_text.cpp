#include "engine/base/toml_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "engine/base/json.h"

namespace lensproof {

namespace {

std::string valid_utf8(std::string_view bytes) {
    return Json::parse(Json(bytes).dump(), "").text();
}

/// `letter` where it may not stand as it is between quotes.
std::string escaped(char letter) {
    switch (letter) {
        case '\\':
            return "\\\\";
        case '"':
            return "\\\"";
        case '\n':
            return "\\n";
        case '\r':
            return "\\r";
        case '\t':
            return "\\t";
        default:
            break;
    }
    const auto code = static_cast<unsigned char>(letter);
    return code < 0x20 || code == 0x7f ? fmt::format("\\u{:04X}", code) : std::string(1, letter);
}

}  // namespace

std::string toml_string(std::string_view bytes) {
    std::string text = "\"";
    for (const char letter : valid_utf8(bytes)) {
        text += escaped(letter);
    }
    return text + '"';
}

std::string toml_paragraph(std::string_view bytes) {
    if (bytes.find('\n') == std::string_view::npos) {
        return toml_string(bytes);
    }
    std::string text = "\"\"\"\n";
    char last = '\0';
    for (const char letter : valid_utf8(bytes)) {
        const bool plain = letter == '\n' || letter == '\t' || (letter == '"' && last != '"');
        text += plain ? std::string(1, letter) : escaped(letter);
        last = letter;
    }
    if (last == '"' && !text.ends_with("\\\"")) {
        text.insert(text.size() - 1, "\\");
    }
    return text + "\"\"\"";
}

std::string toml_strings(const std::vector<std::string>& texts) {
    std::vector<std::string> each;
    std::ranges::transform(texts, std::back_inserter(each), toml_string);
    return fmt::format("[{}]", fmt::join(each, ", "));
}

std::string toml_key(const std::string& name) {
    const bool bare = !name.empty() && std::ranges::all_of(name, [](char letter) {
        return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
               (letter >= '0' && letter <= '9') || letter == '-' || letter == '_';
    });
    return bare ? name : toml_string(name);
}

}  // namespace lensproof
