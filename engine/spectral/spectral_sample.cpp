#include "engine/spectral/spectral_sample.h"

#include <fmt/format.h>

#include <limits>

#include "engine/base/input_error.h"

namespace lensproof::spectral {

namespace {

constexpr int kMostStrata = std::numeric_limits<std::uint16_t>::max() + 1;

}  // namespace

std::array<double, kWavelengthsPerPath> SpectralGrid::wavelengths_nm(const PathWavelengths& path) const {
    std::array<double, kWavelengthsPerPath> wavelengths_nm{};
    for (std::size_t i = 0; i < kWavelengthsPerPath; ++i) {
        wavelengths_nm[i] = strata.midpoint(path.index[i]);
    }
    return wavelengths_nm;
}

SpectralGrid spectral_grid(double min_nm, double max_nm, int count) {
    if (count < 1 || count > kMostStrata || count % kWavelengthsPerPath != 0) {
        throw InputError(fmt::format("wavelength strata: {} of them, expected a multiple of {} up to {}", count,
                                     kWavelengthsPerPath, kMostStrata));
    }
    return {.strata = wavelength_strata(min_nm, max_nm, count)};
}

GridSpectrum stratum_means(const Spectrum& spectrum, const SpectralGrid& grid) {
    const WavelengthStrata& strata = grid.strata;
    GridSpectrum table;
    for (int i = 0; i < grid.size(); ++i) {
        table.value.push_back(
            static_cast<float>(integral(spectrum, strata.at(i, 0.0), strata.at(i, 1.0)) / strata.width_nm()));
    }
    return table;
}

GridSpectrum at_midpoints(const Spectrum& spectrum, const SpectralGrid& grid) {
    if (spectrum.wavelength_nm.empty()) {
        return constant_spectrum(0.0, grid);
    }
    const double first_nm = spectrum.wavelength_nm.front();
    const double last_nm = spectrum.wavelength_nm.back();
    return tabulated(grid, [&](double nm) { return spectrum(std::clamp(nm, first_nm, last_nm)); });
}

GridSpectrum constant_spectrum(double value, const SpectralGrid& grid) {
    return tabulated(grid, [&](double) { return value; });
}

}  // namespace lensproof::spectral
