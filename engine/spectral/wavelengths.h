// engine/spectral/wavelengths.h — the wavelengths that a render samples, and the lines that glass is measured at.
#pragma once
#include <span>
#include <string_view>
#include <vector>

namespace lensproof::spectral {

inline constexpr double kMmPerNm = 1e-6;

// Wavelengths in nm, in standard air: catalogue indices, colour-matching functions and illuminants are tabulated so.
// The lines are ISO 7944:1998 (Optics and optical instruments — Reference wavelengths) and the further ones that glass
// catalogues use, as in Schott TIE-29. Line letters are cased: d is helium, D is sodium.
inline constexpr double kLineI = 365.0146;       // i, Hg
inline constexpr double kLineH = 404.6561;       // h, Hg
inline constexpr double kLineG = 435.8343;       // g, Hg
inline constexpr double kLineFPrime = 479.9914;  // F', Cd
inline constexpr double kLineF = 486.1327;       // F, H
inline constexpr double kLineE = 546.0740;       // e, Hg
inline constexpr double kLineD = 587.5618;       // d, He
inline constexpr double kLineSodium = 589.2938;  // D, Na: the middle of the doublet
inline constexpr double kLineCPrime = 643.8469;  // C', Cd
inline constexpr double kLineC = 656.2725;       // C, H
inline constexpr double kLineR = 706.5188;       // r, He
inline constexpr double kLineS = 852.11;         // s, Cs
inline constexpr double kLineT = 1013.98;        // t, Hg

struct SpectralLine {
    std::string_view name;  // as opticians write it: "d", "F'"
    double wavelength_nm = 0.0;
    std::string_view element;
};

/// All of the lines above, from violet to infrared.
std::span<const SpectralLine> spectral_lines();

/// `count` equal strata that fill [min_nm, max_nm]. A renderer evaluates each at its midpoint, or anywhere inside by
/// `at`, and weighs each by `width_nm`; at midpoints that sum is exact for a straight line.
struct WavelengthStrata {
    double min_nm = 380.0;
    double max_nm = 780.0;
    int count = 16;

    [[nodiscard]] double width_nm() const { return (max_nm - min_nm) / count; }
    /// The wavelength at the fraction u in [0, 1] of stratum `index`.
    [[nodiscard]] double at(int index, double u) const { return min_nm + (max_nm - min_nm) * ((index + u) / count); }
    [[nodiscard]] double midpoint(int index) const { return at(index, 0.5); }
    /// Every midpoint, ascending.
    [[nodiscard]] std::vector<double> midpoints() const;
};

/// The strata, checked: throws InputError unless 0 < min_nm < max_nm are finite and count is at least 1.
WavelengthStrata wavelength_strata(double min_nm, double max_nm, int count);

}  // namespace lensproof::spectral
