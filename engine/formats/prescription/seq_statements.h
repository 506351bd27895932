// engine/formats/prescription/seq_statements.h — CODE V command text, cut into statements and words.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace lensproof::formats {

struct SeqWord {
    std::string text;  // as it stands between its quotes, if it has any; else in capitals
    bool is_quoted = false;
};

struct SeqStatement {
    int line = 0;  // where it begins
    std::vector<SeqWord> words;
};

/// Statements end with a line or a semicolon; a line that ends in & goes on in the next one; an exclamation mark begins
/// a comment; quotes ' or " hold what is neither. Statements without words are left out.
std::vector<SeqStatement> seq_statements(std::string_view text);

}  // namespace lensproof::formats
