// tests/unit/svg_checks.h — what every drawing's text has to be.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace lensproof {

inline std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
        ++found;
    }
    return found;
}

/// Elements nest and close, attributes are quoted, no character stands that XML 1.0 forbids, and the references are the
/// five that XML defines: what makes a document of this kind (no comments, no sections) well-formed.
inline ::testing::AssertionResult is_well_formed(const std::string& xml) {
    constexpr std::array references = {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
    const auto is_lower = [](char c) { return c >= 'a' && c <= 'z'; };
    std::vector<std::string> open;
    for (auto at = xml.begin(); at != xml.end();) {
        if (*at == '<') {
            const std::string whole(at, std::find(at, xml.end(), '>'));
            const bool closes = whole.starts_with("</");
            const auto name_start = whole.begin() + (closes ? 2 : 1);
            const std::string name(name_start, std::find_if_not(name_start, whole.end(), is_lower));
            if (name.empty() || count(whole, "\"") % 2 != 0 || count(whole, "<") != 1) {
                return ::testing::AssertionFailure() << "no tag: " << whole.substr(0, 80);
            }
            if (closes && (open.empty() || open.back() != name)) {
                return ::testing::AssertionFailure() << "closes what is not open: " << name;
            }
            if (closes) {
                open.pop_back();
            } else if (!whole.ends_with("/")) {
                open.push_back(name);
            }
            at += static_cast<std::ptrdiff_t>(whole.size()) + 1;
            continue;
        }
        const std::string_view rest(&*at, std::min<std::size_t>(xml.end() - at, 6));
        if (*at == '&' && std::ranges::none_of(references, [&](const char* r) { return rest.starts_with(r); })) {
            return ::testing::AssertionFailure() << "no reference: " << rest;
        }
        const auto byte = static_cast<unsigned char>(*at);
        if ((byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7F) {
            return ::testing::AssertionFailure() << "control character " << int{byte};
        }
        ++at;
    }
    return open.empty() ? ::testing::AssertionSuccess() : ::testing::AssertionFailure() << "left open: " << open.back();
}

/// No number in an attribute is NaN or infinite. (Words may hold "inf".)
inline bool has_bad_number(const std::string& svg) {
    for (auto at = svg.find("=\""); at != std::string::npos; at = svg.find("=\"", at + 2)) {
        const std::string value = svg.substr(at + 2, svg.find('"', at + 2) - at - 2);
        if (value.find("nan") != std::string::npos || value.find("inf") != std::string::npos) {
            return true;
        }
    }
    return false;
}

}  // namespace lensproof
