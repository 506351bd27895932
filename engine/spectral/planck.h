// engine/spectral/planck.h — the radiance of a black body.
#pragma once

namespace lensproof::spectral {

// The 2018 SI (BIPM, SI Brochure, 9th edition, 2019); all three are exact.
inline constexpr double kPlanckConstant = 6.62607015e-34;   // J·s
inline constexpr double kSpeedOfLight = 299792458.0;        // m/s
inline constexpr double kBoltzmannConstant = 1.380649e-23;  // J/K

/// Planck's law, L = 2hc²/λ⁵ / (exp(hc/λkT) − 1): spectral radiance in W·m⁻²·sr⁻¹·nm⁻¹ at `wavelength_nm` > 0 of a
/// black body at `temperature_k` > 0, in a medium of index 1. (Air would move a wavelength by 0.03 %, within what
/// colorimetry neglects: CIE 15:2004 defines illuminant A without it too.)
double planck_radiance(double wavelength_nm, double temperature_k);

}  // namespace lensproof::spectral
