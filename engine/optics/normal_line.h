// engine/optics/normal_line.h — dispersion of a glass of which a table states n_d and V_d alone.
#pragma once
#include <array>
#include <span>

#include "engine/optics/dispersion.h"

namespace lensproof::optics {

struct Glass;

/// The glass that such figures most likely mean: n = n_d + (n_F − n_C) P(λ), where n_F − n_C = (n_d − 1) / V_d and
///     P(λ) = w(λ) + Σ s_j χ_j(λ),  w(λ) = (λ⁻² − λ_d⁻²) / (λ_F⁻² − λ_C⁻²),
///     χ_j(λ) = λ^p_j − λ_d^p_j − (λ_F^p_j − λ_C^p_j) w(λ),  p = −4, −8, 2,  λ in µm,
/// so that n_d and V_d are met exactly. The three s_j are linear in 1, V_d, 1/V_d and n_d, with coefficients from a
/// least squares fit to the 1869 glasses of SCHOTT, OHARA, HOYA, HIKARI and CDGM that ship. That is the idea of the
/// "normal line" on which partial dispersions lie (SCHOTT TIE-29), for every wavelength from 365 to 1014 nm at once.
/// Its error is 2.2e-4 rms at 400 nm, 8.2e-5 at g, 2.4e-4 at 1014 nm; a quadratic in Buchdahl's coordinate on SCHOTT's
/// line P_gF = 0.6438 − 0.001682 V_d has 8.2e-4, 3.8e-4 and 6.5e-4. Glasses off the normal line (PK, FK, KZFS, the
/// heaviest SF) err most: see `normal_line_error`. Outside 15 ≤ V_d ≤ 100, 1.4 ≤ n_d ≤ 2.2 the s_j are those of the
/// nearest edge.
NormalLine normal_line(double n_d, double V_d);

/// Where that model is fitted, nm.
inline constexpr double kNormalLineMinNm = 365.0;
inline constexpr double kNormalLineMaxNm = 1014.0;

/// P(λ) at λ in µm.
double normal_line_shape(const std::array<double, 3>& shape, double wavelength_um);

/// How far the model is from real glasses.
struct ModelError {
    double rms = 0.0;
    double percentile_95 = 0.0;  // 95 % of the glasses err less
    double largest = 0.0;
    int glasses = 0;  // over how many
};

/// The error in n to expect at one wavelength, from what the model does to the catalogue's own glasses: the 40 nearest
/// to (n_d, V_d) whose formulas cover the wavelength, where 0.05 in n_d counts as much as 5 % in V_d. Nearly zero
/// around d, where the model is exact. Zero glasses, and zero errors, where no formula covers the wavelength.
ModelError normal_line_error(std::span<const Glass> glasses, double n_d, double V_d, double wavelength_nm);

}  // namespace lensproof::optics
