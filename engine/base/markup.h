// engine/base/markup.h — text that may come from anyone, made safe to stand in a page or a drawing.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lensproof {

/// `text` as it can stand between tags and inside a quoted attribute, in HTML and in XML: & < > " ' become character
/// references; what XML 1.0 forbids (control characters but line ends and tabs, bytes that are not UTF-8), and what
/// turns the direction of text, becomes U+FFFD.
std::string escape_markup(std::string_view text);

/// The characters of UTF-8 text, each as its bytes; what is none comes byte by byte, as U+FFFD.
std::vector<std::string_view> markup_characters(std::string_view text);

/// RFC 4648, section 4, with padding.
std::string base64(std::string_view bytes);

/// The bytes that `base64` made the text of; nothing where it is no such text.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace lensproof
