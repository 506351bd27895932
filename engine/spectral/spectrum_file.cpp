// Reading spectra from CSV files.
#include <fmt/format.h>

#include <optional>

#include "engine/base/csv.h"
#include "engine/base/data_root.h"
#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/spectral/spectrum.h"

namespace lensproof::spectral {

namespace {

constexpr const char* kWavelengthColumn = "wavelength_nm";

}  // namespace

std::vector<Spectrum> parse_spectra(const std::string& text, const std::filesystem::path& file,
                                    const std::vector<std::string>& columns) {
    CsvTable table = CsvTable::parse(text, file);
    if (table.header().front() != kWavelengthColumn) {
        throw InputError(fmt::format("{}: the first column is \"{}\", expected {}", table.where_header(),
                                     printable(table.header().front()), kWavelengthColumn));
    }
    std::vector<Spectrum> spectra(columns.size());
    std::size_t rows = 0;
    double previous_nm = 0.0;
    while (const std::optional<CsvRow> row = table.next()) {
        const double wavelength_nm = row->number(kWavelengthColumn);
        if (wavelength_nm <= previous_nm) {
            row->fail(kWavelengthColumn, fmt::format("more than {}, as wavelengths ascend", previous_nm));
        }
        for (std::size_t i = 0; i < columns.size(); ++i) {
            spectra[i].wavelength_nm.push_back(wavelength_nm);
            spectra[i].value.push_back(row->number(columns[i]));
        }
        previous_nm = wavelength_nm;
        ++rows;
    }
    if (rows < 2) {
        throw InputError(fmt::format("{}: {} rows of numbers, expected at least 2", file.string(), rows));
    }
    return spectra;
}

std::vector<Spectrum> read_spectra(const std::filesystem::path& file, const std::vector<std::string>& columns) {
    return parse_spectra(read_file(file), file, columns);
}

std::filesystem::path spectral_data(const std::string& name) {
    return data_root() / "engine/spectral/data" / name;
}

}  // namespace lensproof::spectral
