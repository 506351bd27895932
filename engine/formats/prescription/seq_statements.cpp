#include "engine/formats/prescription/seq_statements.h"

#include <algorithm>

#include "engine/base/text.h"

namespace lensproof::formats {

namespace {

/// The words of a line up to its end, its comment or its semicolon, put behind `words`; what is left of the line.
std::string_view take_words(std::string_view line, std::vector<SeqWord>& words) {
    while (true) {
        line = trimmed(line);
        if (line.empty() || line[0] == '!') {
            return {};
        }
        if (line[0] == ';') {
            return line;
        }
        if (line[0] == '\'' || line[0] == '"') {
            const std::size_t end = std::min(line.find(line[0], 1), line.size());
            words.push_back({.text = std::string(line.substr(1, end - 1)), .is_quoted = true});
            line.remove_prefix(std::min(line.size(), end + 1));
            continue;
        }
        const std::size_t end = std::min(line.find_first_of(" \t\r\n;!'\",", 1), line.size());
        SeqWord word{.text = upper_case(line.substr(0, end))};
        if (word.text != ",") {
            words.push_back(std::move(word));
        }
        line.remove_prefix(end);
    }
}

}  // namespace

std::vector<SeqStatement> seq_statements(std::string_view text) {
    std::vector<SeqStatement> statements;
    SeqStatement statement;
    const auto finish = [&] {
        if (!statement.words.empty()) {
            statements.push_back(std::move(statement));
        }
        statement = {};
    };
    int number = 0;
    for (const std::string_view whole : lines_of(text)) {
        ++number;
        std::string_view line = trimmed(whole);
        const bool goes_on = line.ends_with('&');
        if (goes_on) {
            line.remove_suffix(1);
        }
        while (true) {
            if (statement.words.empty()) {
                statement.line = number;
            }
            line = take_words(line, statement.words);
            if (line.empty()) {
                break;
            }
            finish();
            line.remove_prefix(1);  // the semicolon
        }
        if (!goes_on) {
            finish();
        }
    }
    finish();
    return statements;
}

}  // namespace lensproof::formats
