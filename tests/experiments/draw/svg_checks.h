// tests/experiments/draw/svg_checks.h — what every drawing's text has to be.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/draw/svg.h"

namespace lensproof::draw {

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

/// The `d` of every path of that class.
inline std::vector<std::string> path_data(const std::string& svg, const std::string& class_name) {
    std::vector<std::string> found;
    const std::regex pattern("<path d=\"([^\"]*)\"[^>]*class=\"" + class_name + "\"");
    for (std::sregex_iterator at(svg.begin(), svg.end(), pattern), end; at != end; ++at) {
        found.push_back((*at)[1]);
    }
    return found;
}

/// A word of the drawing and the box that it takes, by the width that the layout reckons with.
struct Word {
    std::string text;
    double left, top, right, bottom;
};

inline std::vector<Word> words(const std::string& svg) {
    std::vector<Word> found;
    const std::regex pattern("<text x=\"([^\"]*)\" y=\"([^\"]*)\" font-size=\"([^\"]*)\"([^>]*)>([^<]*)</text>");
    for (std::sregex_iterator at(svg.begin(), svg.end(), pattern), end; at != end; ++at) {
        const std::string rest = (*at)[4];
        const double size = std::stod((*at)[3]);
        const double width = svg_text_width(std::string((*at)[5]), size);
        const double before = rest.find("\"middle\"") != std::string::npos ? 0.5
                              : rest.find("\"end\"") != std::string::npos  ? 1.0
                                                                           : 0.0;
        const double x = std::stod((*at)[1]);
        const double y = std::stod((*at)[2]);
        // Ascenders reach 0.75 of the size above the baseline, descenders 0.2 below.
        const bool is_upright = rest.find("rotate(-90") != std::string::npos;
        found.push_back(
            is_upright
                ? Word{(*at)[5], x - 0.75 * size, y - (1.0 - before) * width, x + 0.2 * size, y + before * width}
                : Word{(*at)[5], x - before * width, y - 0.75 * size, x + (1.0 - before) * width, y + 0.2 * size});
    }
    return found;
}

inline ::testing::AssertionResult words_keep_clear(const std::string& svg) {
    const std::vector<Word> all = words(svg);
    for (auto a = all.begin(); a != all.end(); ++a) {
        for (auto b = a + 1; b != all.end(); ++b) {
            if (a->left < b->right && b->left < a->right && a->top < b->bottom && b->top < a->bottom) {
                return ::testing::AssertionFailure() << "'" << a->text << "' covers '" << b->text << "'";
            }
        }
    }
    return ::testing::AssertionSuccess();
}

inline ::testing::AssertionResult is_sound(const std::string& svg) {
    if (has_bad_number(svg)) {
        return ::testing::AssertionFailure() << "a number that is none";
    }
    const auto formed = is_well_formed(svg);
    return formed ? words_keep_clear(svg) : formed;
}

}  // namespace lensproof::draw
