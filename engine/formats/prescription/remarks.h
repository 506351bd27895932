// engine/formats/prescription/remarks.h — what a reader of another program's file has to say about it, each thing once.
#pragma once
#include <map>
#include <set>
#include <string>
#include <vector>

#include "engine/formats/prescription/design_command.h"
#include "engine/optics/finding.h"

namespace lensproof::formats {

/// Collects findings while a file is read. Surfaces are counted as the file does (0 is the object) until `renumbered`.
class Remarks {
  public:
    void add(std::string code, optics::Severity severity, int surface, std::string message);

    /// As `add`, but only the first time that `code` is used with `key`.
    void add_once(const std::string& key, std::string code, optics::Severity severity, int surface,
                  std::string message);

    /// "line 7, surface 2 of the file: SQAP: `what`", the first time for each code, or on a surface (not 0) for each
    /// code and keyword.
    void at(const Command& command, std::string code, optics::Severity severity, int surface, const std::string& what);

    /// That a word of the file is not understood: once for each word, with the number of its lines, and of not more
    /// than a hundred words.
    void not_understood(const std::string& word, int surface, int line, const std::string& what = "");

    /// The findings with their surfaces counted as `row_of` maps the file's numbers: to rows from 1, or to 0.
    [[nodiscard]] std::vector<optics::Finding> renumbered(const std::vector<int>& row_of) const;

  private:
    std::vector<optics::Finding> findings_;
    std::set<std::string> said_;
    struct Unknown {
        std::size_t finding = 0;  // the first line's
        int lines = 1;
    };
    std::map<std::string, Unknown> not_understood_;  // by word
    int unsaid_ = 0;                                 // lines of further words
};

}  // namespace lensproof::formats
