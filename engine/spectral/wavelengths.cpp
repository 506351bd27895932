#include "engine/spectral/wavelengths.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/input_error.h"

namespace lensproof::spectral {

std::span<const SpectralLine> spectral_lines() {
    static constexpr std::array<SpectralLine, 13> kLines{{
        {"i", kLineI, "Hg"},
        {"h", kLineH, "Hg"},
        {"g", kLineG, "Hg"},
        {"F'", kLineFPrime, "Cd"},
        {"F", kLineF, "H"},
        {"e", kLineE, "Hg"},
        {"d", kLineD, "He"},
        {"D", kLineSodium, "Na"},
        {"C'", kLineCPrime, "Cd"},
        {"C", kLineC, "H"},
        {"r", kLineR, "He"},
        {"s", kLineS, "Cs"},
        {"t", kLineT, "Hg"},
    }};
    return kLines;
}

std::vector<double> WavelengthStrata::midpoints() const {
    std::vector<double> wavelengths_nm;
    wavelengths_nm.reserve(static_cast<std::size_t>(std::max(count, 0)));
    for (int index = 0; index < count; ++index) {
        wavelengths_nm.push_back(midpoint(index));
    }
    return wavelengths_nm;
}

WavelengthStrata wavelength_strata(double min_nm, double max_nm, int count) {
    if (!(min_nm > 0.0 && max_nm > min_nm && std::isfinite(max_nm))) {
        throw InputError(fmt::format(
            "wavelengths from {} to {} nm: expected two positive wavelengths in ascending order", min_nm, max_nm));
    }
    if (count < 1) {
        throw InputError(fmt::format("{} wavelengths: expected at least 1", count));
    }
    return {.min_nm = min_nm, .max_nm = max_nm, .count = count};
}

}  // namespace lensproof::spectral
