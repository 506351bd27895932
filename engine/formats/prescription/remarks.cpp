#include "engine/formats/prescription/remarks.h"

#include <fmt/format.h>

#include "engine/base/text.h"

namespace lensproof::formats {

void Remarks::add(std::string code, optics::Severity severity, int surface, std::string message) {
    findings_.push_back({std::move(code), severity, surface, std::move(message)});
}

void Remarks::add_once(const std::string& key, std::string code, optics::Severity severity, int surface,
                       std::string message) {
    if (said_.insert(code + " " + key).second) {
        add(std::move(code), severity, surface, std::move(message));
    }
}

void Remarks::at(const Command& command, std::string code, optics::Severity severity, int surface,
                 const std::string& what) {
    const std::string of_surface = surface > 0 ? fmt::format(", surface {} of the file", surface) : "";
    add_once(surface > 0 ? command.keyword + of_surface : "", std::move(code), severity, surface,
             fmt::format("line {}{}: {}: {}", command.line, of_surface, printable(command.keyword), what));
}

void Remarks::not_understood(const std::string& word, int surface, int line, const std::string& what) {
    constexpr std::size_t kMostWords = 100;
    const std::string shown = printable(word);
    const auto known = not_understood_.find(shown);
    if (known != not_understood_.end()) {
        ++known->second.lines;
    } else if (not_understood_.size() < kMostWords) {
        not_understood_[shown] = {.finding = findings_.size()};
        add("not-understood", optics::Severity::warning, surface,
            fmt::format("line {}{}: {} is not understood and left out{}", line,
                        surface > 0 ? fmt::format(", surface {} of the file", surface) : "", shown,
                        what.empty() ? "" : ": " + what));
    } else {
        ++unsaid_;
    }
}

std::vector<optics::Finding> Remarks::renumbered(const std::vector<int>& row_of) const {
    std::vector<optics::Finding> findings = findings_;
    for (optics::Finding& finding : findings) {
        const auto number = static_cast<std::size_t>(finding.surface);
        finding.surface = finding.surface >= 0 && number < row_of.size() ? row_of[number] : 0;
    }
    for (const auto& [word, said] : not_understood_) {
        if (said.lines > 1) {
            findings[said.finding].message += fmt::format(" ({} lines of it)", said.lines);
        }
    }
    if (unsaid_ > 0) {
        findings.push_back({"not-understood", optics::Severity::warning, 0,
                            fmt::format("{} further lines are not understood and left out", unsaid_)});
    }
    return findings;
}

}  // namespace lensproof::formats
