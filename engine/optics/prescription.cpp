#include "engine/optics/prescription.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "engine/io/file.h"
#include "engine/io/input_error.h"
#include "engine/io/toml.h"

namespace lensproof {

namespace {

constexpr std::array kProjections = {Projection::rectilinear, Projection::equidistant, Projection::equisolid,
                                     Projection::stereographic, Projection::orthographic};

// Far beyond any lens, far below what would cost digits.
constexpr double kLargestLength = 1e7;

void check_stop(const Prescription& prescription) {
    const auto stops = std::ranges::count_if(prescription.surfaces, &PrescribedSurface::is_stop);
    if (stops != 1) {
        throw InputError(fmt::format("{}: the prescription has {} aperture stops, expected exactly one",
                                     prescription.file.string(), stops));
    }
}

double read_curvature(TomlTable& row) {
    if (!row.has("radius_mm")) {
        return 0.0;
    }
    if (row.infinity("radius_mm") != 0) {
        return 0.0;
    }
    const double radius = row.number("radius_mm");
    if (std::abs(radius) < 1e-3) {
        row.fail("radius_mm",
                 fmt::format("is {}, expected a radius in mm; a flat surface has inf, or no radius_mm", radius));
    }
    return 1.0 / radius;
}

PrescribedSurface read_surface(TomlTable& row) {
    PrescribedSurface surface;
    surface.is_stop = row.boolean_or("stop", false);
    surface.curvature = read_curvature(row);
    surface.thickness_mm = row.number("thickness_mm", {.min = 0.0, .max = kLargestLength});
    surface.semi_diameter_mm =
        row.number("semi_diameter_mm", {.min = 0.0, .max = kLargestLength, .min_excluded = true});
    surface.medium.glass = row.text_or("glass", "");
    surface.medium.n_d = row.optional_number("n_d", {.min = 1.0, .max = 4.0});
    surface.medium.V_d = row.optional_number("V_d", {.min = 1.0, .max = 1000.0});
    surface.where = row.where();
    if (!surface.medium.glass.empty() && surface.medium.n_d) {
        row.fail("n_d", "stands beside a glass name: expected one of the two");
    }
    if (surface.medium.V_d && !surface.medium.n_d) {
        row.fail("V_d", "stands without n_d");
    }
    row.finish();
    return surface;
}

Prescription read_toml(const std::filesystem::path& file) {
    TomlTable top = TomlTable::read(file);
    Prescription prescription;
    prescription.file = file;
    prescription.name = top.text("name");
    prescription.source = top.text("source");
    prescription.notes = top.text_or("notes", "");
    if (top.has("projection")) {
        std::vector<std::string> names;
        std::ranges::transform(kProjections, std::back_inserter(names), projection_name);
        const std::string name = top.choice("projection", names);
        prescription.projection = kProjections[std::ranges::find(names, name) - names.begin()];
    }
    if (std::optional<TomlTable> stated = top.optional_table("stated")) {
        prescription.stated = {.efl_mm = stated->optional_number("efl_mm"),
                               .bfl_mm = stated->optional_number("bfl_mm"),
                               .f_number = stated->optional_number("f_number", kPositive),
                               .half_field_deg = stated->optional_number("half_field_deg", kPositive),
                               .image_circle_mm = stated->optional_number("image_circle_mm", kPositive)};
        stated->finish();
    }
    for (TomlTable& row : top.tables("surfaces")) {
        prescription.surfaces.push_back(read_surface(row));
    }
    top.finish();
    if (prescription.surfaces.empty()) {
        top.fail("surfaces", "holds no surface");
    }
    return prescription;
}

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
        if (std::abs(value) < 1e-3 && !surface.is_stop) {  // lens tables write a stop's plane as 0
            throw InputError(
                fmt::format("{} is {}, expected a radius in mm, or inf for a flat", row.where("radius_mm"), value));
        }
        surface.curvature = surface.is_stop ? 0.0 : 1.0 / value;
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

Prescription read_csv(const std::filesystem::path& file) {
    static const std::vector<std::string> kColumns = {"surface", "radius_mm", "thickness_mm",    "n_d",
                                                      "V_d",     "kind",      "semi_aperture_mm"};
    Prescription prescription;
    prescription.file = file;
    prescription.name = file.stem().string();
    prescription.source = "the file " + file.filename().string();
    std::istringstream content(read_file(file));
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

}  // namespace

std::string projection_name(Projection projection) {
    switch (projection) {
        case Projection::rectilinear:
            return "rectilinear";
        case Projection::equidistant:
            return "equidistant";
        case Projection::equisolid:
            return "equisolid";
        case Projection::stereographic:
            return "stereographic";
        case Projection::orthographic:
            return "orthographic";
    }
    return "unknown";
}

double projected_radius(Projection projection, double field_angle) {
    switch (projection) {
        case Projection::rectilinear:
            return std::tan(field_angle);
        case Projection::equidistant:
            return field_angle;
        case Projection::equisolid:
            return 2.0 * std::sin(0.5 * field_angle);
        case Projection::stereographic:
            return 2.0 * std::tan(0.5 * field_angle);
        case Projection::orthographic:
            return std::sin(field_angle);
    }
    return 0.0;
}

Prescription read_prescription(const std::filesystem::path& file) {
    Prescription prescription = file.extension() == ".csv" ? read_csv(file) : read_toml(file);
    check_stop(prescription);
    return prescription;
}

std::vector<std::string> shipped_lens_names() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(data_root() / "lenses")) {
        if (entry.path().extension() == ".toml" && entry.path().stem() != "glasses") {
            names.push_back(entry.path().stem().string());
        }
    }
    std::ranges::sort(names);
    return names;
}

std::filesystem::path find_lens_file(const std::string& lens) {
    std::filesystem::path shipped = data_root() / "lenses" / (lens + ".toml");
    const bool is_name = lens.find('/') == std::string::npos && lens.find('.') == std::string::npos;
    if (is_name && !lens.empty() && std::filesystem::exists(shipped)) {
        return shipped;
    }
    if (!std::filesystem::exists(lens)) {
        throw InputError(fmt::format("{}: neither a file nor a lens that ships; those are: {}", lens,
                                     fmt::join(shipped_lens_names(), ", ")));
    }
    std::filesystem::path path(lens);
    if (path.extension() != ".toml" && path.extension() != ".csv") {
        throw InputError(fmt::format("{}: a prescription of an unknown kind, expected .toml or .csv", lens));
    }
    return path;
}

}  // namespace lensproof
