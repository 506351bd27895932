// engine/spectral/metal.h — metals by name: their complex refractive index.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/spectral/spectrum.h"

namespace lensproof::spectral {

/// n + ik, relative to air, at room temperature.
struct ComplexIndex {
    Spectrum n;
    Spectrum k;
};

/// The names that `metal` takes: "aluminium", "chromium", "copper", "gold", "iron", "silver".
std::vector<std::string> known_metals();

/// The metal called `name`, as measured on opaque films, 310 to 1080 nm: Johnson and Christy 1972 and 1974, aluminium
/// Rakić 1995. Throws InputError listing the names known.
ComplexIndex metal(const std::string& name);

/// A metal of one's own: the columns n and k of a CSV file. Throws InputError naming file and line, also where n or k
/// is negative or both are 0.
ComplexIndex read_complex_index(const std::filesystem::path& file);

}  // namespace lensproof::spectral
