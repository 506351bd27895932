// engine/spectral/spectrum.h — a quantity tabulated over wavelength, its exact integrals, and the files it comes from.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace lensproof::spectral {

/// Samples at strictly ascending wavelengths, joined by straight lines, and zero outside the first and last sample.
/// The unit is the owner's: relative, or W·m⁻²·sr⁻¹·nm⁻¹, or any other. Without samples it is zero everywhere.
struct Spectrum {
    std::vector<double> wavelength_nm;  // in standard air
    std::vector<double> value;          // one for each wavelength

    [[nodiscard]] double operator()(double at_nm) const;
};

Spectrum operator*(double scale, Spectrum spectrum);

/// `spectrum` from `from_nm` to `to_nm` (> from_nm) and zero outside; without samples where it had none there.
Spectrum clipped(const Spectrum& spectrum, double from_nm, double to_nm);

/// ∫ s dλ, over all wavelengths or from `from_nm` to `to_nm` (≥ from_nm). Exact for the straight lines.
double integral(const Spectrum& spectrum);
double integral(const Spectrum& spectrum, double from_nm, double to_nm);

/// ∫ a b dλ over all wavelengths. Exact: between samples a b is a parabola, and Simpson's rule integrates parabolas.
double integral_of_product(const Spectrum& a, const Spectrum& b);

/// The named columns of a CSV file, in that order. Lines that start with '#' are comments; the first other line is the
/// header, `wavelength_nm` and then a name for each column; the rest are numbers, wavelengths ascending.
/// Throws InputError naming the file, the line, what was found and what is expected.
std::vector<Spectrum> read_spectra(const std::filesystem::path& file, const std::vector<std::string>& columns);

/// The same from a text; `file` stands for it in messages.
std::vector<Spectrum> parse_spectra(const std::string& text, const std::filesystem::path& file,
                                    const std::vector<std::string>& columns);

/// The path of one of the project's own tables, engine/spectral/data/`name`.
std::filesystem::path spectral_data(const std::string& name);

}  // namespace lensproof::spectral
