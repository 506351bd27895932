// The plain table: surface,radius_mm,thickness_mm,n_d,V_d,semi_aperture_mm,kind, and where wanted glass, conic, A1 …
// A20 and n_C, n_F, n_g. Tables elsewhere name the same columns R, d, nd, vd, K and so on; those are read too.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/base/csv.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/base/text_encoding.h"
#include "engine/formats/prescription/design_program.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::formats {

namespace {

/// A column, and what it is called elsewhere.
struct ColumnNames {
    std::string_view name;
    std::vector<std::string_view> others;
};

const ColumnNames kSurface{"surface", {"Surface", "surf"}};
const ColumnNames kRadius{"radius_mm", {"R", "r", "radius"}};
const ColumnNames kThickness{"thickness_mm", {"d", "t", "thickness"}};
const ColumnNames kIndex{"n_d", {"nd", "n"}};
const ColumnNames kAbbe{"V_d", {"vd", "V", "v_d", "Vd"}};
const ColumnNames kSemiDiameter{"semi_aperture_mm", {"semi_diameter_mm", "semi_diameter", "sd"}};
const ColumnNames kKind{"kind", {}};
const ColumnNames kGlass{"glass", {"material"}};
const ColumnNames kConic{"conic", {"K", "k"}};

/// Columns of indices at other lines.
struct LineColumn {
    ColumnNames names;
    double wavelength_nm;
};
const std::vector<LineColumn> kLineColumns = {
    {{"n_g", {"ng"}}, spectral::kLineG}, {{"n_F", {"nF"}}, spectral::kLineF}, {{"n_C", {"nC"}}, spectral::kLineC}};

/// The table's columns by what they mean; an absent one is empty.
struct Columns {
    std::string surface, radius, thickness, index, abbe, semi_diameter, kind, glass, conic;
    std::vector<std::pair<std::string, double>> lines;  // name, wavelength
    std::vector<std::pair<std::string, int>> terms;     // name, power of r
};

/// The power of r in "A4", or 0.
int term_power(const std::string& column) {
    if (column.size() < 2 || column.size() > 3 || column[0] != 'A') {
        return 0;
    }
    const std::optional<double> power = parse_number(std::string_view(column).substr(1));
    return power && *power >= 1.0 && *power <= 99.0 && *power == std::floor(*power) ? static_cast<int>(*power) : 0;
}

class CsvPrescription {
  public:
    CsvPrescription(const std::string& text, const std::filesystem::path& file)
        : table_(CsvTable::parse(text, file)), file_(file), prescription_(prescription_of(file)) {
        find_columns();
        read_comments(text);
    }

    optics::Prescription read() {
        while (const std::optional<CsvRow> row = table_.next()) {
            if (prescription_.surfaces.size() == kMostSurfaces) {
                throw InputError(
                    fmt::format("{}:{}: more than {} surfaces", file_.string(), row->line(), kMostSurfaces));
            }
            prescription_.surfaces.push_back(read_surface(*row));
        }
        if (prescription_.surfaces.empty()) {
            throw InputError(fmt::format("{}: holds no surface", file_.string()));
        }
        return std::move(prescription_);
    }

  private:
    void remark(const std::string& code, int surface, const std::string& message,
                optics::Severity severity = optics::Severity::warning) {
        prescription_.remarks.push_back({code, severity, surface, message});
    }

    std::string find(const ColumnNames& names) {
        for (const std::string& column : table_.header()) {
            if (column == names.name || std::ranges::find(names.others, column) != names.others.end()) {
                known_.insert(column);
                return column;
            }
        }
        return "";
    }

    std::string require(const ColumnNames& names) {
        std::string column = find(names);
        if (column.empty()) {
            throw InputError(
                fmt::format("{}: the header has no column {}, expected "
                            "surface,radius_mm,thickness_mm,n_d,V_d,semi_aperture_mm,kind",
                            table_.where_header(), names.name));
        }
        return column;
    }

    void find_columns() {
        columns_.radius = require(kRadius);
        columns_.thickness = require(kThickness);
        columns_.glass = find(kGlass);
        columns_.index = columns_.glass.empty() ? require(kIndex) : find(kIndex);
        columns_.surface = find(kSurface);
        columns_.abbe = find(kAbbe);
        columns_.semi_diameter = find(kSemiDiameter);
        columns_.kind = find(kKind);
        columns_.conic = find(kConic);
        for (const LineColumn& line : kLineColumns) {
            if (const std::string column = find(line.names); !column.empty()) {
                columns_.lines.emplace_back(column, line.wavelength_nm);
            }
        }
        for (const std::string& column : table_.header()) {
            if (const int power = term_power(column); power != 0) {
                columns_.terms.emplace_back(column, power);
            } else if (!known_.contains(column)) {
                remark("column-not-read", 0, fmt::format("the column \"{}\" is not understood", printable(column)));
            }
        }
    }

    /// The comments' first line names the lens, as do "product:" and "source:" what they say; the rest are notes.
    void read_comments(std::string_view text) {
        std::vector<std::string> notes;
        bool named = false;
        bool sourced = false;
        bool has_hidden_terms = false;
        for (std::string_view line : lines_of(without_byte_order_mark(text))) {
            line = trimmed(line);
            if (!line.starts_with('#')) {
                continue;
            }
            line = trimmed(line.substr(std::min(line.find_first_not_of('#'), line.size())));
            const std::size_t colon = line.find(": ");
            const std::string_view key = colon == std::string_view::npos ? "" : line.substr(0, colon);
            const std::string value(colon == std::string_view::npos ? line : trimmed(line.substr(colon + 1)));
            if (!named && (key == "product" || key == "name" || (key.empty() && notes.empty() && !line.empty()))) {
                prescription_.name = value;
                named = true;
            } else if (!sourced && (key == "source" || key == "patent/source of numbers")) {
                prescription_.source = value;
                sourced = true;
            } else if (!line.empty()) {
                notes.emplace_back(line);
                if (!has_hidden_terms && key.find("surface") != std::string_view::npos &&
                    line.find("A4") != std::string_view::npos) {
                    has_hidden_terms = true;
                    remark("comment-not-read", 0,
                           fmt::format("aspheric terms in a comment are not read, expected them in columns conic, A4, "
                                       "A6, …: {}",
                                       printable(line)));
                }
            }
        }
        prescription_.notes = fmt::format("{}", fmt::join(notes, "\n"));
    }

    /// The number in an optional column's cell, NaN and infinities included.
    static std::optional<double> stated(const CsvRow& row, const std::string& column, std::string_view expected) {
        return column.empty() || row.is_empty(column) ? std::nullopt : std::optional(row.any_number(column, expected));
    }

    optics::PrescribedSurface read_surface(const CsvRow& row) {
        const int number = static_cast<int>(prescription_.surfaces.size()) + 1;
        const std::string label = columns_.surface.empty() ? std::to_string(number) : row.text(columns_.surface);
        optics::PrescribedSurface surface;
        surface.where = row.where(fmt::format("surface {}", printable(label)));
        const std::string kind = read_kind(row, label);
        surface.is_stop = kind == "stop";
        surface.radius_mm = stated(row, columns_.radius, "a radius in mm, or inf for a flat").value_or(kInfinity);
        surface.thickness_mm = row.any_number(columns_.thickness, "a length in mm");
        surface.semi_diameter_mm = stated(row, columns_.semi_diameter, "a length in mm");
        surface.conic = stated(row, columns_.conic, "a conic constant").value_or(0.0);
        read_terms(row, number, surface);
        surface.medium = read_medium(row, number, surface.is_stop);
        if ((kind == "air" && !surface.medium.is_air()) || (kind == "glass" && surface.medium.is_air())) {
            remark("kind-contradicts-index", number,
                   fmt::format("said to be followed by {}, but its index says {}; the index is taken", kind,
                               surface.medium.is_air() ? "air" : "glass"));
        }
        return surface;
    }

    /// "stop", "glass", "air", or nothing where the table does not say. Without the column, the stop's label is STO.
    [[nodiscard]] std::string read_kind(const CsvRow& row, const std::string& label) const {
        if (columns_.kind.empty()) {
            return label == "STO" || label == "STOP" || label == "stop" || label == "Stop" ? "stop" : "";
        }
        std::string kind = row.text(columns_.kind);
        if (!kind.empty() && kind != "stop" && kind != "glass" && kind != "air") {
            row.fail(columns_.kind, "stop, glass or air");
        }
        return kind;
    }

    void read_terms(const CsvRow& row, int number, optics::PrescribedSurface& surface) {
        std::vector<std::string> left_out;
        for (const auto& [column, power] : columns_.terms) {
            const double term = stated(row, column, "an aspheric coefficient").value_or(0.0);
            if (power <= optics::kHighestPower) {
                surface.term(power) = term;
            } else if (term != 0.0) {
                left_out.push_back(fmt::format("{} = {}", column, term));
            }
        }
        if (!left_out.empty()) {
            remark("asphere-term-not-read", number,
                   fmt::format("the aspheric terms {} are left out: powers up to r^{} are carried",
                               fmt::join(left_out, ", "), optics::kHighestPower),
                   optics::Severity::error);
        }
    }

    /// What is behind the surface.
    optics::StatedMedium read_medium(const CsvRow& row, int number, bool is_stop) {
        optics::StatedMedium medium;
        medium.glass = columns_.glass.empty() ? "" : row.text(columns_.glass);
        const std::optional<double> n_d = stated(row, columns_.index, "a refractive index");
        const bool is_air = !n_d || *n_d == 1.0 || (is_stop && *n_d == 0.0);
        std::vector<optics::WavelengthValue> lines;
        for (const auto& [column, wavelength_nm] : columns_.lines) {
            const std::optional<double> index = stated(row, column, "a refractive index, or nothing");
            if (index && !(is_air && (*index == 1.0 || *index == 0.0))) {
                lines.push_back({wavelength_nm, *index});
            }
        }
        if (!is_air) {
            medium.n_d = n_d;
            medium.V_d = stated(row, columns_.abbe, "an Abbe number, or nothing");
            lines.push_back({spectral::kLineD, *n_d});
        }
        take_lines(std::move(lines), number, medium);
        return medium;
    }

    /// Indices at further lines are kept beside n_d and V_d where no glass is named and they make a dispersion.
    void take_lines(std::vector<optics::WavelengthValue> lines, int number, optics::StatedMedium& medium) {
        const std::size_t others = lines.size() - (medium.n_d ? 1 : 0);
        const auto leave_out = [&](optics::Severity severity, const std::string& why) {
            remark("lines-not-used", number, fmt::format("its indices at lines beside d are left out: {}", why),
                   severity);
        };
        if (others == 0) {
            return;
        }
        if (!medium.glass.empty()) {
            leave_out(optics::Severity::info, fmt::format("those of {} are taken", printable(medium.glass)));
        } else if (!medium.n_d) {
            leave_out(optics::Severity::warning, "its n_d says air");
        } else if (others < 2) {
            leave_out(optics::Severity::warning, "one says no dispersion, expected two or more");
        } else if (!std::ranges::all_of(
                       lines, [](const optics::WavelengthValue& at) { return at.value >= 1.0 && at.value <= 5.0; })) {
            leave_out(optics::Severity::warning, "expected each from 1 to 5");
        } else {
            std::ranges::sort(lines, {}, &optics::WavelengthValue::wavelength_nm);
            medium.indices = std::move(lines);
        }
    }

    CsvTable table_;
    const std::filesystem::path& file_;
    Columns columns_;
    std::set<std::string> known_;
    optics::Prescription prescription_;
};

}  // namespace

optics::Prescription parse_csv_prescription(const std::string& text, const std::filesystem::path& file) {
    return CsvPrescription(to_utf8(text), file).read();
}

}  // namespace lensproof::formats
