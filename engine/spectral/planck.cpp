#include "engine/spectral/planck.h"

#include <cmath>

namespace lensproof::spectral {

double planck_radiance(double wavelength_nm, double temperature_k) {
    const double wavelength_m = 1e-9 * wavelength_nm;
    const double photon_energy = kPlanckConstant * kSpeedOfLight / wavelength_m;
    const double per_metre = 2.0 * kSpeedOfLight * photon_energy / std::pow(wavelength_m, 4) /
                             std::expm1(photon_energy / (kBoltzmannConstant * temperature_k));
    return 1e-9 * per_metre;
}

}  // namespace lensproof::spectral
