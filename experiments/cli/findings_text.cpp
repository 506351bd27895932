#include "experiments/cli/findings_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <tuple>

#include "engine/base/visible.h"

namespace lensproof::cli {

namespace {

/// What a reader's remark says, without where it stands in the file: "line 7, surface 2 of the file: " or "line 7: ".
std::string_view without_place(std::string_view message) {
    const auto skip = [](std::string_view& text, std::string_view word) {
        const std::size_t end = text.starts_with(word) ? text.find_first_not_of("0123456789", word.size()) : text.npos;
        const bool has_number = end != text.npos && end > word.size();
        text.remove_prefix(has_number ? end : 0);
        return has_number;
    };
    std::string_view rest = message;
    if (!skip(rest, "line ")) {
        return message;
    }
    constexpr std::string_view kOfFile = " of the file";
    if (skip(rest, ", surface ") && rest.starts_with(kOfFile)) {
        rest.remove_prefix(kOfFile.size());
    }
    constexpr std::string_view kEnd = ": ";
    return rest.starts_with(kEnd) ? rest.substr(kEnd.size()) : message;
}

/// "1–4, 7"; the numbers ascend.
std::string ranges_text(const std::vector<int>& numbers) {
    std::vector<std::string> ranges;
    for (std::size_t i = 0; i < numbers.size();) {
        std::size_t last = i;
        while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) {
            ++last;
        }
        ranges.push_back(last == i ? fmt::format("{}", numbers[i])
                                   : fmt::format("{}{}{}", numbers[i], last == i + 1 ? ", " : "–", numbers[last]));
        i = last + 1;
    }
    return fmt::format("{}", fmt::join(ranges, ", "));
}

std::string line(const optics::Finding& finding, const std::string& where, std::string_view message) {
    return fmt::format("  {:7} {:10} {}: {}", optics::severity_name(finding.severity), where, finding.code,
                       visible_in_line(message));
}

bool says_the_same(const optics::Finding& a, const optics::Finding& b) {
    return a.surface > 0 && b.surface > 0 && std::tie(a.code, a.severity) == std::tie(b.code, b.severity) &&
           without_place(a.message) == without_place(b.message);
}

}  // namespace

std::string findings_text(const std::vector<optics::Finding>& findings) {
    std::string text;
    for (auto finding = findings.begin(); finding != findings.end(); ++finding) {
        const auto is_like_it = [&](const optics::Finding& other) { return says_the_same(*finding, other); };
        if (std::any_of(findings.begin(), finding, is_like_it)) {
            continue;  // said where the first of them stands
        }
        std::vector<int> surfaces;
        for (auto other = finding; other != findings.end(); ++other) {
            if (is_like_it(*other)) {
                surfaces.push_back(other->surface);
            }
        }
        std::ranges::sort(surfaces);
        surfaces.erase(std::unique(surfaces.begin(), surfaces.end()), surfaces.end());
        if (surfaces.size() > 1) {
            text += line(*finding, fmt::format("{} surfaces", surfaces.size()), without_place(finding->message)) +
                    fmt::format(" (surfaces {})\n", ranges_text(surfaces));
        } else {
            text += line(*finding, finding->surface > 0 ? fmt::format("surface {}", finding->surface) : "lens",
                         finding->message) +
                    "\n";
        }
    }
    return text;
}

}  // namespace lensproof::cli
