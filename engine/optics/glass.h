// engine/optics/glass.h — a glass as its catalogue states it.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/optics/dispersion.h"
#include "engine/optics/normal_line.h"

namespace lensproof::optics {

/// How the index of a glass changes with temperature, from `reference_C`:
///     Δn_abs = (n² − 1) / (2 n) (D0 Δt + D1 Δt² + D2 Δt³ + (E0 Δt + E1 Δt²) / (λ² − λ_tk²)),  λ in µm
/// (SCHOTT TIE-19, eq. 4). A negative λ_tk stands for λ² + λ_tk², as in the makers' tables.
struct ThermalDispersion {
    double d0 = 0.0;  // 1/K
    double d1 = 0.0;  // 1/K²
    double d2 = 0.0;  // 1/K³
    double e0 = 0.0;  // µm²/K
    double e1 = 0.0;  // µm²/K²
    double lambda_tk_um = 0.0;
    double reference_C = 20.0;
};

/// The fraction of light that passes `thickness_mm` of glass, reflections at its surfaces left out.
struct TransmittancePoint {
    double wavelength_nm = 0.0;
    double transmittance = 0.0;
    double thickness_mm = 0.0;
};

/// A glass as its catalogue states it. Indices are relative to air at catalogue conditions and wavelengths are those in
/// air, as catalogues give both; the tracer's air therefore has index 1. air.h leads to indices against vacuum.
struct Glass {
    std::string name;
    std::string catalogue;
    DispersionFormula formula;
    double min_wavelength_nm = 0.0;  // the formula's stated range
    double max_wavelength_nm = 0.0;
    std::optional<double> stated_n_d;
    std::optional<double> stated_V_d;
    std::string status;  // "current", "special" (on request), "obsolete", or nothing where that is not known
    std::string source;
    std::string note;
    std::optional<ThermalDispersion> thermal;
    std::vector<TransmittancePoint> internal_transmittance;  // ascending; for shipped glasses see glass_catalogue.h
};

bool covers(const Glass& glass, double wavelength_nm);

/// dn/dT against vacuum at `temperature_C`, 1/K: the derivative of TIE-19's formula above.
double dn_dT_absolute(const Glass& glass, double wavelength_nm, double temperature_C = 20.0);

/// dn/dT relative to air of the same temperature at 101 325 Pa, as catalogues tabulate it, 1/K. Both are NaN where the
/// glass has no thermal data.
double dn_dT_relative(const Glass& glass, double wavelength_nm, double temperature_C = 20.0);

/// Internal transmittance through `thickness_mm`, by the exponential law and, between tabulated wavelengths, linear in
/// the transmittance at the table's thickness. Nothing outside the table, or without one.
std::optional<double> internal_transmittance(const Glass& glass, double wavelength_nm, double thickness_mm);

/// What is wrong with a glass that was read, in words, or nothing: the range has to be finite and ascending, and the
/// index real, above 0 and below 20 at 65 wavelengths across it.
std::string complaint_about(const Glass& glass);

}  // namespace lensproof::optics
