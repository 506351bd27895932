// engine/base/csv.h — CSV tables with a header, read row by row, so that every complaint names file, line and column.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/bounds.h"

namespace lensproof {

/// A text as a cell: without line ends, in quotes where it needs them.
std::string csv_cell(std::string text);

/// One row of a `CsvTable`; its cells are asked for by column. All members throw InputError
/// `file:line: column is "cell", expected …`, and for a column that the table does not have.
class CsvRow {
  public:
    /// The cell's text, without the blanks and the quotes around it.
    [[nodiscard]] std::string text(std::string_view column) const;
    /// Whether nothing, or nothing but blanks, stands in the cell.
    [[nodiscard]] bool is_empty(std::string_view column) const;

    /// A finite number inside `bounds`. `expected` says in the lens person's words what belongs there, in place of the
    /// bounds.
    [[nodiscard]] double number(std::string_view column, const Bounds& bounds = kAnyNumber,
                                std::string_view expected = "") const;
    /// The same, or nothing where the cell is empty.
    [[nodiscard]] std::optional<double> optional_number(std::string_view column, const Bounds& bounds = kAnyNumber,
                                                        std::string_view expected = "") const;
    /// Any number, inf and nan included: for who judges them later.
    [[nodiscard]] double any_number(std::string_view column, std::string_view expected = "a number") const;

    [[nodiscard]] int line() const { return line_; }
    /// "file:line: column".
    [[nodiscard]] std::string where(std::string_view column) const;
    /// Throws InputError `file:line: column is "cell", expected <expected>`.
    [[noreturn]] void fail(std::string_view column, std::string_view expected) const;

  private:
    friend class CsvTable;
    struct Table;
    CsvRow(std::shared_ptr<const Table> table, int line) : table_(std::move(table)), line_(line) {}
    [[nodiscard]] std::string_view cell(std::string_view column) const;

    std::shared_ptr<const Table> table_;  // holds the text that the cells look into
    std::vector<std::string_view> cells_;
    int line_ = 0;
};

/// A CSV file: a header that names the columns, then rows of as many cells.
///
/// Lines end with LF, CR LF or CR, a UTF-8 byte order mark is skipped, and so are empty lines and those that start with
/// '#'. Blanks around a cell are no part of it. A cell may stand in double quotes, and then hold commas, and quotes
/// written twice; it ends in its own line. Rows are cut when they are asked for, so a file takes no more memory than
/// its text.
class CsvTable {
  public:
    /// Reads a file and its header. Throws InputError where it cannot be read, holds no header, or the header has an
    /// unnamed column or the same column twice.
    static CsvTable read(const std::filesystem::path& file);
    /// The same from a text; `name` stands for the file in messages.
    static CsvTable parse(std::string text, const std::filesystem::path& name);

    [[nodiscard]] const std::vector<std::string>& header() const;
    [[nodiscard]] bool has(std::string_view column) const;
    /// Throws InputError naming header and expectation unless every column of `required` is there, in any order, and
    /// no column but these and those of `optional`.
    void expect_columns(const std::vector<std::string>& required, const std::vector<std::string>& optional = {}) const;
    /// The header as messages quote it: what is no list of names is cut after its first word.
    [[nodiscard]] std::string shown_header() const;
    /// "file:line" of the header.
    [[nodiscard]] std::string where_header() const;

    /// The next row, or nothing after the last. Throws InputError for a row with another number of cells than the
    /// header, or with a quote that does not end with its cell.
    std::optional<CsvRow> next();

  private:
    explicit CsvTable(std::shared_ptr<CsvRow::Table> table) : table_(std::move(table)) {}
    /// The next line that is neither empty nor a comment; moves `position_` and `line_`.
    std::optional<std::string_view> next_line();

    std::shared_ptr<CsvRow::Table> table_;
    std::size_t position_ = 0;
    int line_ = 0;
};

}  // namespace lensproof
