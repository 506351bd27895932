// A prescription as the plain CSV table that prescription_csv.cpp reads. Optional columns stand where a surface needs
// them.
#include <fmt/format.h>

#include <algorithm>

#include "engine/base/csv.h"
#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/formats/prescription/axial_terms.h"
#include "engine/formats/prescription/prescription_forms.h"
#include "engine/formats/prescription/prescription_losses.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::formats {

namespace {

/// Whether the indices are those at d and at least two of the lines that have columns.
bool fits_line_columns(const optics::StatedMedium& medium) {
    const std::vector<optics::WavelengthValue>& indices = medium.indices;
    const auto has = [&](double wavelength_nm) {
        return std::ranges::count(indices, wavelength_nm, &optics::WavelengthValue::wavelength_nm);
    };
    const auto others = has(spectral::kLineG) + has(spectral::kLineF) + has(spectral::kLineC);
    const auto at_d = std::ranges::find(indices, spectral::kLineD, &optics::WavelengthValue::wavelength_nm);
    if (at_d == indices.end() || at_d->value != medium.n_d.value_or(at_d->value)) {
        return false;
    }
    return others >= 2 && 1 + others == std::ssize(indices);
}

/// The index at a wavelength that the medium states, as a cell.
std::string index_cell(const optics::StatedMedium& medium, double wavelength_nm) {
    const auto found = std::ranges::find(medium.indices, wavelength_nm, &optics::WavelengthValue::wavelength_nm);
    return found == medium.indices.end() ? "" : fmt::format("{}", found->value);
}

std::string cell_of(const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : "";
}

std::string comment_lines(const std::string& key, std::string_view text) {
    std::string lines;
    for (const std::string_view line : lines_of(text)) {
        lines += fmt::format("# {}{}\n", key, trimmed(line));
    }
    return lines;
}

/// Which optional columns the prescription needs.
struct Needs {
    bool glass = false;
    bool lines = false;
    bool conic = false;
    std::array<bool, optics::kHighestPower + 1> terms{};  // by their power of r

    explicit Needs(const optics::Prescription& prescription) {
        for (const optics::PrescribedSurface& row : prescription.surfaces) {
            glass = glass || !row.medium.glass.empty();
            lines = lines || fits_line_columns(row.medium);
            conic = conic || row.conic != 0.0;
            for (int power = 1; power <= optics::kHighestPower; ++power) {
                terms[power] = terms[power] || row.term(power) != 0.0;
            }
        }
    }

    [[nodiscard]] std::string header() const {
        std::string text = "surface,radius_mm,thickness_mm,n_d,V_d,semi_aperture_mm,kind";
        text += glass ? ",glass" : "";
        text += lines ? ",n_C,n_F,n_g" : "";
        text += conic ? ",conic" : "";
        for (int power = 1; power <= optics::kHighestPower; ++power) {
            text += terms[power] ? fmt::format(",A{}", power) : "";
        }
        return text + "\n";
    }

    [[nodiscard]] std::string cells(const optics::PrescribedSurface& row) const {
        std::string text;
        text += glass ? "," + csv_cell(row.medium.glass) : "";
        if (lines) {
            const bool fits = fits_line_columns(row.medium);
            for (const double line : {spectral::kLineC, spectral::kLineF, spectral::kLineG}) {
                text += "," + (fits ? index_cell(row.medium, line) : "");
            }
        }
        text += conic ? fmt::format(",{}", row.conic) : "";
        for (int power = 1; power <= optics::kHighestPower; ++power) {
            text += terms[power] ? fmt::format(",{}", row.term(power)) : "";
        }
        return text;
    }
};

}  // namespace

WrittenPrescription to_csv(const optics::Prescription& prescription) {
    WrittenPrescription written;
    optics::Prescription lens = single_position(prescription, written.lost);
    state_along_axis(lens, written.lost);
    std::ranges::copy(losses_of_tables(lens), std::back_inserter(written.lost));
    try {
        state_rims(lens, written.lost);
    } catch (const InputError& error) {
        written.lost.push_back(
            lost("lost-aperture", optics::Severity::warning, 0,
                 fmt::format("clear apertures that the lens does not state are left out: {}", error.what())));
    }
    const Needs needs(lens);
    written.text = comment_lines("name: ", lens.name) + comment_lines("source: ", lens.source) +
                   comment_lines("", lens.notes) + needs.header();
    for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
        const optics::PrescribedSurface& row = lens.surfaces[i];
        const optics::StatedMedium& medium = row.medium;
        const int number = static_cast<int>(i) + 1;
        std::string n_d = medium.is_air() ? "1" : cell_of(medium.n_d);
        std::string V_d = medium.n_d ? cell_of(medium.V_d) : "";
        if (fits_line_columns(medium)) {
            n_d = index_cell(medium, spectral::kLineD);
        } else if (!medium.indices.empty()) {
            const auto [index, abbe] = figures_of_table(medium);
            written.lost.push_back(lost("lost-indices", optics::Severity::warning, number,
                                        "its table of indices has not just the lines d, C, F, g that have columns; its "
                                        "n_d and V_d are written"));
            n_d = fmt::format("{}", index);
            V_d = abbe > 0.0 ? fmt::format("{}", abbe) : "";
        }
        written.text += fmt::format("{},{},{},{},{},{},{}{}\n", number, row.is_flat() ? "inf" : cell_of(row.radius_mm),
                                    row.thickness_mm, n_d, V_d, cell_of(plain_semi_diameter(lens, i)),
                                    row.is_stop       ? "stop"
                                    : medium.is_air() ? "air"
                                                      : "glass",
                                    needs.cells(row));
    }
    return written;
}

}  // namespace lensproof::formats
