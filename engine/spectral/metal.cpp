#include "engine/spectral/metal.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/base/input_error.h"

namespace lensproof::spectral {

std::vector<std::string> known_metals() {
    return {"aluminium", "chromium", "copper", "gold", "iron", "silver"};
}

ComplexIndex metal(const std::string& name) {
    const std::vector<std::string> known = known_metals();
    if (std::find(known.begin(), known.end(), name) == known.end()) {
        throw InputError(fmt::format("metal '{}' is not known: expected one of {}", name, fmt::join(known, ", ")));
    }
    return read_complex_index(spectral_data(fmt::format("metal-{}.csv", name)));
}

ComplexIndex read_complex_index(const std::filesystem::path& file) {
    std::vector<Spectrum> columns = read_spectra(file, {"n", "k"});
    for (std::size_t i = 0; i < columns[0].value.size(); ++i) {
        const double n = columns[0].value[i];
        const double k = columns[1].value[i];
        if (n < 0.0 || k < 0.0 || (n == 0.0 && k == 0.0)) {
            throw InputError(fmt::format("{}: n is {} and k is {} at {} nm, expected two numbers >= 0, not both 0",
                                         file.string(), n, k, columns[0].wavelength_nm[i]));
        }
    }
    return {.n = std::move(columns[0]), .k = std::move(columns[1])};
}

}  // namespace lensproof::spectral
