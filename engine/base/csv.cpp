#include "engine/base/csv.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"

namespace lensproof {

struct CsvRow::Table {
    std::string text;
    std::string name;
    std::vector<std::string> header;
    int header_line = 0;
};

namespace {

// More than any table here has; a line of commas would go on for ever.
constexpr std::size_t kMostColumns = 1000;

/// Where the cell ends that begins at `begin`: at a comma, or at the line's end (npos). A comma between quotes is
/// text. Nothing where a quote does not end with its cell.
std::optional<std::size_t> cell_end(std::string_view line, std::size_t begin) {
    std::size_t at = line.find_first_not_of(" \t", begin);
    if (at == std::string_view::npos || line[at] != '"') {
        return line.find(',', begin);
    }
    do {  // a quote written twice closes one stretch and opens the next
        const std::size_t close = line.find('"', at + 1);
        if (close == std::string_view::npos) {
            return std::nullopt;
        }
        at = close + 1;
    } while (at < line.size() && line[at] == '"');
    const std::size_t end = line.find(',', at);
    if (!trimmed(line.substr(at, end == std::string_view::npos ? end : end - at)).empty()) {
        return std::nullopt;
    }
    return end;
}

/// Calls `take` with each cell, blanks around it removed. False where a quote does not end with its cell.
template <class Take>
bool cut(std::string_view line, const Take& take) {
    for (std::size_t begin = 0;;) {
        const std::optional<std::size_t> end = cell_end(line, begin);
        if (!end) {
            return false;
        }
        take(trimmed(line.substr(begin, *end == std::string_view::npos ? *end : *end - begin)));
        if (*end == std::string_view::npos) {
            return true;
        }
        begin = *end + 1;
    }
}

/// A header for a message: of a line that is no list of columns' names, which another kind of file may begin with, no
/// more than its first word.
std::string shown_line(std::string_view line) {
    const bool is_list = std::ranges::all_of(line, [](unsigned char letter) {
        return std::isalnum(letter) != 0 || letter == '_' || letter == ',' || letter == '"';
    });
    return is_list ? printable(line) : printable(line.substr(0, line.find_first_of(" \t,"))) + "…";
}

std::string shown(const std::vector<std::string>& header) {
    return shown_line(fmt::format("{}", fmt::join(header, ",")));
}

/// What a cell says: without the quotes around it, and those inside once.
std::string unquoted(std::string_view cell) {
    if (!cell.starts_with('"')) {
        return std::string(cell);
    }
    std::string text;
    for (std::size_t i = 1; i + 1 < cell.size(); ++i) {
        text += cell[i];
        i += cell[i] == '"' ? 1 : 0;
    }
    return text;
}

}  // namespace

std::string_view CsvRow::cell(std::string_view column) const {
    const auto found = std::ranges::find(table_->header, column);
    if (found == table_->header.end()) {
        throw InputError(fmt::format("{}:{}: the header is \"{}\", expected a column {} in it", table_->name,
                                     table_->header_line, shown(table_->header), column));
    }
    return cells_[found - table_->header.begin()];
}

std::string CsvRow::text(std::string_view column) const {
    return unquoted(cell(column));
}

bool CsvRow::is_empty(std::string_view column) const {
    const std::string_view found = cell(column);
    return found.empty() || found == "\"\"";
}

double CsvRow::number(std::string_view column, const Bounds& bounds, std::string_view expected) const {
    const std::optional<double> number = parse_number(trimmed(text(column)));
    if (!number || !bounds.hold(*number)) {
        fail(column, expected.empty() ? bounds.expectation() : expected);
    }
    return *number;
}

std::optional<double> CsvRow::optional_number(std::string_view column, const Bounds& bounds,
                                              std::string_view expected) const {
    return is_empty(column) ? std::nullopt : std::optional(number(column, bounds, expected));
}

double CsvRow::any_number(std::string_view column, std::string_view expected) const {
    const std::optional<double> number = parse_number(trimmed(text(column)));
    if (!number) {
        fail(column, expected);
    }
    return *number;
}

std::string CsvRow::where(std::string_view column) const {
    return fmt::format("{}:{}: {}", table_->name, line_, column);
}

void CsvRow::fail(std::string_view column, std::string_view expected) const {
    throw InputError(fmt::format("{} is \"{}\", expected {}", where(column), printable(text(column)), expected));
}

CsvTable CsvTable::read(const std::filesystem::path& file) {
    return parse(read_file(file), file);
}

CsvTable CsvTable::parse(std::string text, const std::filesystem::path& name) {
    const auto content = std::make_shared<CsvRow::Table>();
    content->text = std::move(text);
    content->name = name.string();
    CsvTable table(content);
    const std::optional<std::string_view> line = table.next_line();
    if (!line) {
        throw InputError(fmt::format("{}: is empty, expected a table with a header", content->name));
    }
    content->header_line = table.line_;
    std::size_t count = 0;
    const bool whole = cut(*line, [&](std::string_view cell) {
        if (++count <= kMostColumns) {
            content->header.push_back(unquoted(cell));
        }
    });
    const auto refuse = [&](const std::string& complaint) {
        throw InputError(
            fmt::format("{}: the header is \"{}\": {}", table.where_header(), shown_line(*line), complaint));
    };
    if (!whole) {
        refuse("expected a quote to end with its cell");
    }
    if (count > kMostColumns) {
        refuse(fmt::format("{} columns, expected at most {}", count, kMostColumns));
    }
    if (count == 1 && line->find(';') != std::string_view::npos) {
        refuse("its separator is ';', expected ',' between cells and '.' in decimals");
    }
    for (auto column = content->header.begin(); column != content->header.end(); ++column) {
        if (column->empty()) {
            refuse(fmt::format("column {} has no name", column - content->header.begin() + 1));
        }
        if (std::find(content->header.begin(), column, *column) != column) {
            refuse(fmt::format("{} stands there twice", printable(*column)));
        }
    }
    return table;
}

const std::vector<std::string>& CsvTable::header() const {
    return table_->header;
}

bool CsvTable::has(std::string_view column) const {
    return std::ranges::find(table_->header, column) != table_->header.end();
}

std::string CsvTable::shown_header() const {
    return shown(table_->header);
}

void CsvTable::expect_columns(const std::vector<std::string>& required,
                              const std::vector<std::string>& optional) const {
    const bool complete = std::ranges::all_of(required, [&](const std::string& column) { return has(column); });
    const bool known = std::ranges::all_of(table_->header, [&](const std::string& column) {
        return std::ranges::find(required, column) != required.end() ||
               std::ranges::find(optional, column) != optional.end();
    });
    if (!complete || !known) {
        throw InputError(fmt::format(
            "{}: the header is \"{}\", expected \"{}\"{}", where_header(), shown_header(), fmt::join(required, ","),
            optional.empty() ? "" : fmt::format(", and where wanted {}", fmt::join(optional, ", "))));
    }
}

std::string CsvTable::where_header() const {
    return fmt::format("{}:{}", table_->name, table_->header_line);
}

std::optional<std::string_view> CsvTable::next_line() {
    const std::string_view text = table_->text;
    while (position_ < text.size()) {
        // A library's find_first_of would call another function for each letter.
        const auto end_of_line =
            std::ranges::find_if(text.substr(position_), [](char letter) { return letter == '\n' || letter == '\r'; });
        const auto end = static_cast<std::size_t>(end_of_line - text.begin());
        std::string_view line = text.substr(position_, end - position_);
        if (line_ == 0) {
            line = without_byte_order_mark(line);
        }
        position_ = end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
        ++line_;
        line = trimmed(line);
        if (!line.empty() && line.front() != '#') {
            return line;
        }
    }
    return std::nullopt;
}

std::optional<CsvRow> CsvTable::next() {
    const std::optional<std::string_view> line = next_line();
    if (!line) {
        return std::nullopt;
    }
    CsvRow row(table_, line_);
    row.cells_.reserve(table_->header.size());
    std::size_t count = 0;
    const bool whole = cut(*line, [&](std::string_view cell) {
        if (++count <= table_->header.size()) {
            row.cells_.push_back(cell);
        }
    });
    if (!whole) {
        throw InputError(fmt::format("{}:{}: a quote does not end with its cell", table_->name, line_));
    }
    if (count != table_->header.size()) {
        throw InputError(fmt::format("{}:{}: {} cells, expected {} as in the header: {}", table_->name, line_, count,
                                     table_->header.size(), shown(table_->header)));
    }
    return row;
}

std::string csv_cell(std::string text) {
    std::ranges::replace(text, '\n', ' ');
    std::ranges::replace(text, '\r', ' ');
    if (text.find_first_of(",\" ") == std::string::npos) {
        return text;
    }
    std::string cell = "\"";
    for (const char letter : text) {
        cell += letter == '"' ? "\"\"" : std::string(1, letter);
    }
    return cell + '"';
}

}  // namespace lensproof
