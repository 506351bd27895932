// The plain table: surface,radius_mm,thickness_mm,n_d,V_d,semi_aperture_mm,kind.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "engine/io/input_error.h"
#include "engine/io/prescription_forms.h"

namespace lensproof {

namespace {

constexpr double kLargestLength = 1e7;

std::vector<std::string> split_commas(const std::string& line) {
    std::vector<std::string> cells(1);
    for (const char letter : line) {
        if (letter == ',') {
            cells.emplace_back();
        } else if (letter != '\r' && letter != ' ' && letter != '"') {
            cells.back() += letter;
        }
    }
    return cells;
}

/// A row of the plain CSV table: cells by column name, with messages that name file, line and column.
class CsvRow {
  public:
    CsvRow(const std::filesystem::path& file, int line, const std::vector<std::string>& header,
           std::vector<std::string> cells)
        : file_(file), line_(line), header_(header), cells_(std::move(cells)) {
        if (cells_.size() != header.size()) {
            throw InputError(fmt::format("{}:{}: {} cells, expected {} as in the header", file.string(), line,
                                         cells_.size(), header.size()));
        }
    }

    [[nodiscard]] std::string cell(const std::string& column) const {
        return cells_[std::ranges::find(header_, column) - header_.begin()];
    }

    [[nodiscard]] double number(const std::string& column, const std::string& expected, double min,
                                double max = kLargestLength) const {
        const std::string text = cell(column);
        std::istringstream stream(text);
        double value = 0.0;
        stream >> value;
        if (stream.fail() || !stream.eof() || !std::isfinite(value) || value < min || value > max) {
            throw InputError(fmt::format("{} is \"{}\", expected {}", where(column), text, expected));
        }
        return value;
    }

    [[nodiscard]] std::string where(const std::string& column) const {
        return fmt::format("{}:{}: {}", file_.string(), line_, column);
    }

  private:
    const std::filesystem::path& file_;
    int line_;
    const std::vector<std::string>& header_;
    std::vector<std::string> cells_;
};

PrescribedSurface read_csv_surface(const CsvRow& row) {
    PrescribedSurface surface;
    surface.where = row.where("surface " + row.cell("surface"));
    const std::string kind = row.cell("kind");
    if (kind != "stop" && kind != "glass" && kind != "air") {
        throw InputError(fmt::format("{} is \"{}\", expected stop, glass or air", row.where("kind"), kind));
    }
    surface.is_stop = kind == "stop";
    const std::string radius = row.cell("radius_mm");
    const bool flat = radius == "inf" || radius == "-inf" || radius == "Infinity" || radius.empty();
    if (!flat) {
        const double value = row.number("radius_mm", "a radius in mm, or inf for a flat", -kLargestLength);
        surface.radius_mm = surface.is_stop ? std::numeric_limits<double>::infinity() : value;
    }
    surface.thickness_mm = row.number("thickness_mm", "a length that is not negative", 0.0);
    surface.semi_diameter_mm = row.number("semi_aperture_mm", "a positive length", 1e-9);
    const std::string n_d = row.cell("n_d");
    const double index = n_d.empty() ? 1.0 : row.number("n_d", "a refractive index from 1 to 4", 1.0, 4.0);
    if (index != 1.0) {
        surface.medium.n_d = index;
        if (!row.cell("V_d").empty()) {
            surface.medium.V_d = row.number("V_d", "an Abbe number from 1 to 1000", 1.0, 1000.0);
        }
    }
    return surface;
}

}  // namespace

Prescription parse_csv_prescription(const std::string& text, const std::filesystem::path& file) {
    static const std::vector<std::string> kColumns = {"surface", "radius_mm", "thickness_mm",    "n_d",
                                                      "V_d",     "kind",      "semi_aperture_mm"};
    Prescription prescription;
    prescription.file = file;
    prescription.name = file.stem().string();
    prescription.source = "the file " + file.filename().string();
    std::istringstream content(text);
    std::vector<std::string> header;
    std::string line;
    for (int number = 1; std::getline(content, line); ++number) {
        if (number == 1 && line.starts_with("\xEF\xBB\xBF")) {
            line.erase(0, 3);  // a byte order mark
        }
        if (line.empty() || line == "\r" || line.front() == '#') {
            continue;
        }
        if (header.empty()) {
            header = split_commas(line);
            for (const std::string& column : kColumns) {
                if (std::ranges::find(header, column) == header.end()) {
                    throw InputError(fmt::format("{}:{}: the header has no column {}, expected {}", file.string(),
                                                 number, column, fmt::join(kColumns, ",")));
                }
            }
            for (const std::string& column : header) {
                if (std::ranges::find(kColumns, column) == kColumns.end()) {
                    throw InputError(fmt::format("{}:{}: the column \"{}\" is not one that is known here; known are {}",
                                                 file.string(), number, column, fmt::join(kColumns, ",")));
                }
            }
            continue;
        }
        prescription.surfaces.push_back(read_csv_surface(CsvRow(file, number, header, split_commas(line))));
    }
    if (prescription.surfaces.empty()) {
        throw InputError(fmt::format("{}: holds no surface", file.string()));
    }
    return prescription;
}

}  // namespace lensproof
