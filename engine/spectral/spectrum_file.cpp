// Reading spectra from CSV files.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include "engine/io/file.h"
#include "engine/io/input_error.h"
#include "engine/spectral/spectrum.h"

namespace lensproof {

namespace {

constexpr std::string_view kWavelengthColumn = "wavelength_nm";

/// One line of the file, and where it stands in it.
struct Line {
    std::string where;  // "file:12"
    std::vector<std::string_view> cells;
};

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) {
        return {};
    }
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (std::size_t begin = 0;;) {
        const std::size_t end = text.find(separator, begin);
        parts.push_back(trimmed(text.substr(begin, end - begin)));
        if (end == std::string_view::npos) {
            return parts;
        }
        begin = end + 1;
    }
}

/// The lines that are neither blank nor comments. The cells look into `text`.
std::vector<Line> table_lines(std::string_view text, const std::filesystem::path& file) {
    std::vector<Line> lines;
    int number = 0;
    for (const std::string_view line : split(text, '\n')) {
        ++number;
        if (!line.empty() && line.front() != '#') {
            lines.push_back({.where = fmt::format("{}:{}", file.string(), number), .cells = split(line, ',')});
        }
    }
    return lines;
}

double number_in(const Line& line, std::size_t column) {
    const std::string_view cell = line.cells[column];
    double number = 0.0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(number)) {
        throw InputError(fmt::format("{}: cell {} is '{}': expected a number", line.where, column + 1, cell));
    }
    return number;
}

/// The wavelengths, which have to be positive and ascend.
std::vector<double> read_wavelengths(const std::vector<Line>& rows) {
    std::vector<double> wavelengths_nm;
    for (const Line& row : rows) {
        const double wavelength_nm = number_in(row, 0);
        const double previous_nm = wavelengths_nm.empty() ? 0.0 : wavelengths_nm.back();
        if (wavelength_nm <= previous_nm) {
            throw InputError(fmt::format("{}: wavelength_nm is {}: expected more than {}, as wavelengths ascend",
                                         row.where, wavelength_nm, previous_nm));
        }
        wavelengths_nm.push_back(wavelength_nm);
    }
    return wavelengths_nm;
}

std::size_t find_column(const Line& header, const std::string& name) {
    for (std::size_t column = 1; column < header.cells.size(); ++column) {
        if (header.cells[column] == name) {
            return column;
        }
    }
    throw InputError(
        fmt::format("{}: columns are {}: expected one called {}", header.where, fmt::join(header.cells, ", "), name));
}

}  // namespace

std::vector<Spectrum> parse_spectra(const std::string& text, const std::filesystem::path& file,
                                    const std::vector<std::string>& columns) {
    std::vector<Line> rows = table_lines(text, file);
    if (rows.empty()) {
        throw InputError(
            fmt::format("{}: no line but comments: expected a header '{},...'", file.string(), kWavelengthColumn));
    }
    const Line header = rows.front();
    rows.erase(rows.begin());
    if (header.cells.front() != kWavelengthColumn) {
        throw InputError(fmt::format("{}: the first column is '{}': expected {}", header.where, header.cells.front(),
                                     kWavelengthColumn));
    }
    if (rows.size() < 2) {
        throw InputError(fmt::format("{}: {} rows of numbers: expected at least 2", file.string(), rows.size()));
    }
    for (const Line& row : rows) {
        if (row.cells.size() != header.cells.size()) {
            throw InputError(fmt::format("{}: {} cells: expected {}, as in the header", row.where, row.cells.size(),
                                         header.cells.size()));
        }
    }
    const std::vector<double> wavelengths_nm = read_wavelengths(rows);
    std::vector<Spectrum> spectra;
    for (const std::string& name : columns) {
        const std::size_t column = find_column(header, name);
        Spectrum& spectrum = spectra.emplace_back(Spectrum{.wavelength_nm = wavelengths_nm, .value = {}});
        for (const Line& row : rows) {
            spectrum.value.push_back(number_in(row, column));
        }
    }
    return spectra;
}

std::vector<Spectrum> read_spectra(const std::filesystem::path& file, const std::vector<std::string>& columns) {
    return parse_spectra(read_file(file), file, columns);
}

std::filesystem::path spectral_data(const std::string& name) {
    return data_root() / "engine/spectral/data" / name;
}

}  // namespace lensproof
