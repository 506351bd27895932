#include "engine/optics/glass.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "engine/optics/air.h"

namespace lensproof::optics {

bool covers(const Glass& glass, double wavelength_nm) {
    return wavelength_nm >= glass.min_wavelength_nm && wavelength_nm <= glass.max_wavelength_nm;
}

double dn_dT_absolute(const Glass& glass, double wavelength_nm, double temperature_C) {
    if (!glass.thermal) {
        return kNaN;
    }
    const ThermalDispersion& t = *glass.thermal;
    const double n = refractive_index(glass.formula, wavelength_nm);
    const double dt = temperature_C - t.reference_C;
    const double um = 1e-3 * wavelength_nm;
    const double resonance = um * um - std::copysign(t.lambda_tk_um * t.lambda_tk_um, t.lambda_tk_um);
    return (n * n - 1.0) / (2.0 * n) *
           (t.d0 + 2.0 * t.d1 * dt + 3.0 * t.d2 * dt * dt + (t.e0 + 2.0 * t.e1 * dt) / resonance);
}

double dn_dT_relative(const Glass& glass, double wavelength_nm, double temperature_C) {
    const double n = refractive_index(glass.formula, wavelength_nm);
    const double air = air_index(vacuum_wavelength_nm(wavelength_nm), temperature_C);
    const double air_slope = -(air - 1.0) / (temperature_C + 273.15);  // an ideal gas thins with temperature
    return (dn_dT_absolute(glass, wavelength_nm, temperature_C) - n * air_slope) / air;
}

std::optional<double> internal_transmittance(const Glass& glass, double wavelength_nm, double thickness_mm) {
    const auto& table = glass.internal_transmittance;
    const auto above = std::ranges::lower_bound(table, wavelength_nm, {}, &TransmittancePoint::wavelength_nm);
    if (above == table.end() || (above == table.begin() && above->wavelength_nm != wavelength_nm)) {
        return std::nullopt;
    }
    const auto through = [&](const TransmittancePoint& point) {
        return std::pow(point.transmittance, thickness_mm / point.thickness_mm);
    };
    if (above->wavelength_nm == wavelength_nm) {
        return through(*above);
    }
    const TransmittancePoint& a = *(above - 1);
    const double t = (wavelength_nm - a.wavelength_nm) / (above->wavelength_nm - a.wavelength_nm);
    if (a.thickness_mm != above->thickness_mm) {
        return (1.0 - t) * through(a) + t * through(*above);
    }
    return through({.wavelength_nm = wavelength_nm,
                    .transmittance = (1.0 - t) * a.transmittance + t * above->transmittance,
                    .thickness_mm = a.thickness_mm});
}

std::string complaint_about(const Glass& glass) {
    const double min = glass.min_wavelength_nm;
    const double max = glass.max_wavelength_nm;
    if (!(min > 0.0 && min < max && max <= 1e7)) {
        return fmt::format("its range is {} to {} nm, expected two ascending wavelengths", min, max);
    }
    constexpr int kSteps = 64;
    for (int i = 0; i <= kSteps; ++i) {
        const double nm = min + (max - min) * i / kSteps;
        const double n = refractive_index(glass.formula, nm);
        if (!(n > 0.0 && n < 20.0)) {
            return fmt::format("its index at {:.4g} nm is {:.4g}, expected one above 0 and below 20", nm, n);
        }
    }
    return {};
}

}  // namespace lensproof::optics
