// engine/optics/glass.h — refractive indices of optical glass from catalogue formulas.
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace lensproof {

/// n² − 1 = Σ B_i λ² / (λ² − C_i), λ in µm (Sellmeier 1871; SCHOTT's present form).
struct Sellmeier {
    std::array<double, 3> b{};
    std::array<double, 3> c{};  // µm²
};

/// n² = a0 + a1 λ² + a2 λ⁻² + a3 λ⁻⁴ + a4 λ⁻⁶ + a5 λ⁻⁸, λ in µm (SCHOTT's form until 1992; HIKARI still uses it).
struct SchottPolynomial {
    std::array<double, 6> a{};
};

/// The same index at every wavelength.
struct ConstantIndex {
    double index = 1.0;
};

/// What is left when a table states n_d and V_d alone: n = n_d + ν₁ω + ν₂ω² with Buchdahl's ω = (λ − λ_d) / (1 + 2.5 (λ
/// − λ_d)), λ in µm (Robb & Mercado, Appl. Opt. 22, 1198, 1983). ν₁ and ν₂ are such that n_F − n_C = (n_d − 1) / V_d
/// and the glass lies on SCHOTT's normal line P_gF = 0.6438 − 0.001682 V_d (SCHOTT TIE-29). See `buchdahl_normal_line`.
struct BuchdahlNormalLine {
    double n_d = 1.0;
    double nu1 = 0.0;
    double nu2 = 0.0;
};

using DispersionFormula = std::variant<ConstantIndex, Sellmeier, SchottPolynomial, BuchdahlNormalLine>;

/// A glass as its catalogue states it. Indices are relative to air at catalogue conditions, as catalogues give them,
/// and the tracer's air therefore has index 1.
struct Glass {
    std::string name;
    std::string catalogue;
    DispersionFormula formula;
    double min_wavelength_nm = 0.0;  // the formula's stated range
    double max_wavelength_nm = 0.0;
    double stated_n_d = 0.0;
    double stated_V_d = 0.0;
    std::string source;
};

/// The index at a vacuum-scale catalogue wavelength in nm. No range check: see `covers`.
double refractive_index(const DispersionFormula& formula, double wavelength_nm);

bool covers(const Glass& glass, double wavelength_nm);

/// V_d = (n_d − 1) / (n_F − n_C).
double abbe_number(const DispersionFormula& formula);

BuchdahlNormalLine buchdahl_normal_line(double n_d, double V_d);

/// The glasses that ship, in the file's order. Throws InputError naming the file and line of an entry that is unusable.
std::vector<Glass> read_glasses(const std::filesystem::path& file);

/// `read_glasses` on lenses/glasses.toml.
std::vector<Glass> shipped_glasses();

/// The glass of that name (letter case aside), or nothing. No guessing: LAK9 is not N-LAK9.
std::optional<Glass> find_glass(const std::vector<Glass>& glasses, const std::string& name);

}  // namespace lensproof
