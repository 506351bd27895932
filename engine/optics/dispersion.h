// engine/optics/dispersion.h — refractive index as a function of wavelength: the formulas of glass catalogues.
//
// Throughout, λ is the wavelength in µm as the catalogue gives it. For catalogue glass that is the wavelength in air,
// and the index is relative to air of the catalogue's conditions (about 20 °C and 101 325 Pa). See air.h for the step
// to vacuum.
#pragma once
#include <array>
#include <variant>
#include <vector>

namespace lensproof::optics {

/// The same index at every wavelength.
struct ConstantIndex {
    double index = 1.0;
    bool operator==(const ConstantIndex&) const = default;
};

/// n² − 1 = constant + Σ B λ² / (λ² − C), C in µm² (Sellmeier 1871; SCHOTT's present form, with three terms and no
/// constant).
struct Sellmeier {
    struct Term {
        double b = 0.0;
        double c = 0.0;
        bool operator==(const Term&) const = default;
    };
    std::vector<Term> terms;
    double constant = 0.0;
    bool operator==(const Sellmeier&) const = default;
};

/// n² = a0 + a1 λ² + a2 λ⁻² + a3 λ⁻⁴ + a4 λ⁻⁶ + a5 λ⁻⁸ (SCHOTT's form until 1992; HOYA and CDGM still use it).
struct SchottPolynomial {
    std::array<double, 6> a{};
    bool operator==(const SchottPolynomial&) const = default;
};

/// coefficient · λ^exponent.
struct PowerTerm {
    double coefficient = 0.0;
    double exponent = 0.0;
    bool operator==(const PowerTerm&) const = default;
};

/// n² = Σ c λ^p: the "extended" forms of SCHOTT's polynomial, as HIKARI uses them.
struct SquaredPowerSeries {
    std::vector<PowerTerm> terms;
    bool operator==(const SquaredPowerSeries&) const = default;
};

/// n = Σ c λ^p: Cauchy (exponents 0, −2, −4) and Conrady (0, −1, −3.5).
struct PowerSeries {
    std::vector<PowerTerm> terms;
    bool operator==(const PowerSeries&) const = default;
};

/// n² = Σ b λ^p / (λ² − c) + Σ d λ^q: what has resonances and powers both, as the formulas of the Handbook of Optics.
struct ResonancesAndPowers {
    struct Resonance {
        double b = 0.0;
        double power = 0.0;
        double c = 0.0;  // µm²
        bool operator==(const Resonance&) const = default;
    };
    std::vector<Resonance> resonances;
    std::vector<PowerTerm> powers;
    bool operator==(const ResonancesAndPowers&) const = default;
};

/// n = a0 + a1 L + a2 L² + a3 λ² + a4 λ⁴ + a5 λ⁶ with L = 1 / (λ² − 0.028) (Herzberger, Opt. Acta 6, 197, 1959).
struct Herzberger {
    std::array<double, 6> a{};
    bool operator==(const Herzberger&) const = default;
};

/// n − 1 = constant + Σ b / (c − λ⁻²), c in µm⁻²: gases.
struct GasDispersion {
    std::vector<Sellmeier::Term> terms;
    double constant = 0.0;
    bool operator==(const GasDispersion&) const = default;
};

/// (n² − 1) / (n² + 2) = a0 + a1 λ² / (λ² − a2) + a3 λ² (refractiveindex.info formula 8, "retro").
struct RetroDispersion {
    std::array<double, 4> a{};
    bool operator==(const RetroDispersion&) const = default;
};

/// n² = a0 + a1 / (λ² − a2) + a3 (λ − a4) / ((λ − a4)² + a5) (refractiveindex.info formula 9, "exotic").
struct ExoticDispersion {
    std::array<double, 6> a{};
    bool operator==(const ExoticDispersion&) const = default;
};

/// Measured indices, ascending in wavelength. Between them a cubic in λ⁻², with the slopes of the parabolas through
/// three neighbours, limited so that the curve turns nowhere but where the table does (Hyman, SIAM J. Sci. Stat.
/// Comput. 4, 645, 1983); beyond its ends the nearest index. N-BK7 from a table at the 13 lines from i to t comes out
/// within 4e-5, and within 3e-6 between h and r.
struct IndexTable {
    std::vector<double> wavelength_um;
    std::vector<double> index;
    bool operator==(const IndexTable&) const = default;
};

/// A glass of which n_d and V_d alone are known: see normal_line.h, where such are made.
struct NormalLine {
    double n_d = 1.0;
    double dispersion = 0.0;        // n_F − n_C
    std::array<double, 3> shape{};  // how its partial dispersions depart from λ⁻²
    bool operator==(const NormalLine&) const = default;
};

using DispersionFormula =
    std::variant<ConstantIndex, Sellmeier, SchottPolynomial, SquaredPowerSeries, PowerSeries, ResonancesAndPowers,
                 Herzberger, GasDispersion, RetroDispersion, ExoticDispersion, IndexTable, NormalLine>;

/// The index at a wavelength in nm. No range check: see `covers` in glass.h. NaN where the formula has no real value.
double refractive_index(const DispersionFormula& formula, double wavelength_nm);

/// V_d = (n_d − 1) / (n_F − n_C).
double abbe_number(const DispersionFormula& formula);

/// V_e = (n_e − 1) / (n_F′ − n_C′).
double abbe_number_e(const DispersionFormula& formula);

/// P_xy = (n_x − n_y) / (n_F − n_C) between two wavelengths in nm; P_gF is that of the g and F lines.
double partial_dispersion(const DispersionFormula& formula, double x_nm, double y_nm);

}  // namespace lensproof::optics
