#include "engine/spectral/illuminant.h"

#include <fmt/format.h>

#include <string_view>

#include "engine/base/input_error.h"
#include "engine/base/text.h"
#include "engine/spectral/colour_matching.h"
#include "engine/spectral/planck.h"

namespace lensproof::spectral {

namespace {

// What is computed, not tabulated, covers all that silicon sees.
constexpr int kFirstNm = 300;
constexpr int kLastNm = 1100;
constexpr double kColdest = 500.0;
constexpr double kHottest = 100000.0;
constexpr std::string_view kBlackbody = "blackbody:";
constexpr int kFluorescentLamps = 12;

/// A CIE illuminant that is a table: a column of a file.
struct Table {
    std::string name;
    const char* file;
    std::string column;
};

std::vector<Table> tables() {
    std::vector<Table> all = {{"D65", "illuminant-d65.csv", "relative_power"},
                              {"D50", "illuminant-d50.csv", "relative_power"},
                              {"A", "illuminant-a.csv", "relative_power"}};
    for (int lamp = 1; lamp <= kFluorescentLamps; ++lamp) {
        all.push_back({fmt::format("F{}", lamp), "illuminants-f.csv", fmt::format("f{}", lamp)});
    }
    return all;
}

Spectrum blackbody(double temperature_k) {
    Spectrum spectrum;
    for (int wavelength_nm = kFirstNm; wavelength_nm <= kLastNm; ++wavelength_nm) {
        spectrum.wavelength_nm.push_back(wavelength_nm);
        spectrum.value.push_back(planck_radiance(wavelength_nm, temperature_k));
    }
    return spectrum;
}

double temperature_in(const std::string& name) {
    const double temperature_k = parse_exact<double>(name.substr(kBlackbody.size())).value_or(0.0);
    if (!(temperature_k >= kColdest && temperature_k <= kHottest)) {
        throw InputError(fmt::format("illuminant '{}': expected a temperature from {} to {} K after '{}'", name,
                                     kColdest, kHottest, kBlackbody));
    }
    return temperature_k;
}

/// `light` such that K_m ∫ S V dλ = `luminous`: cd/m² for a radiance, lx for an irradiance.
Spectrum at_luminous(const Illuminant& light, double luminous) {
    return luminous / (kMaximumLuminousEfficacy * integral_of_product(light.relative, photopic_efficiency())) *
           light.relative;
}

}  // namespace

std::vector<std::string> known_illuminants() {
    std::vector<std::string> names;
    for (const Table& table : tables()) {
        names.push_back(table.name);
    }
    names.insert(names.end(), {"E", "blackbody:<kelvin>"});
    return names;
}

Illuminant illuminant(const std::string& name) {
    for (const Table& table : tables()) {
        if (table.name == name) {
            return {.name = name, .relative = read_spectra(spectral_data(table.file), {table.column}).front()};
        }
    }
    if (name == "E") {
        return {.name = name, .relative = {.wavelength_nm = {kFirstNm, kLastNm}, .value = {1.0, 1.0}}};
    }
    if (name.starts_with(kBlackbody)) {
        return {.name = name, .relative = blackbody(temperature_in(name))};
    }
    throw InputError(
        fmt::format("illuminant '{}' is not known: expected one of {}", name, fmt::join(known_illuminants(), ", ")));
}

Spectrum radiance_of(const Illuminant& light, double luminance_cd_m2) {
    return at_luminous(light, luminance_cd_m2);
}

Spectrum irradiance_of(const Illuminant& light, double illuminance_lx) {
    return at_luminous(light, illuminance_lx);
}

}  // namespace lensproof::spectral
