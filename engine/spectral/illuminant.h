// engine/spectral/illuminant.h — light sources by name, scaled to what a light meter reads.
#pragma once
#include <string>
#include <vector>

#include "engine/spectral/spectrum.h"

namespace lensproof::spectral {

struct Illuminant {
    std::string name;
    Spectrum relative;  // spectral power per nm, in any scale
};

/// The names that `illuminant` takes: "D65" and "A" (CIE standard illuminants, 300 to 830 nm), "D50" (to 780 nm), "F1"
/// to "F12" (the CIE's fluorescent lamps, 380 to 780 nm), "E" (equal energy) and "blackbody:<kelvin>" (Planck's law,
/// 500 to 100000 K), the last two from 300 to 1100 nm.
std::vector<std::string> known_illuminants();

/// The illuminant called `name`, say "A" or "blackbody:3200". Throws InputError listing the names known.
Illuminant illuminant(const std::string& name);

/// The spectral radiance in W·m⁻²·sr⁻¹·nm⁻¹ of that light at a luminance (≥ 0) of K_m ∫ L V dλ = `luminance_cd_m2`.
Spectrum radiance_of(const Illuminant& light, double luminance_cd_m2);

/// The spectral irradiance in W·m⁻²·nm⁻¹ of that light at an illuminance (≥ 0) of K_m ∫ E V dλ = `illuminance_lx`.
Spectrum irradiance_of(const Illuminant& light, double illuminance_lx);

}  // namespace lensproof::spectral
