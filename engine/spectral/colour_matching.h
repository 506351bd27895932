// engine/spectral/colour_matching.h — what the CIE's standard observer sees of a spectrum: luminance and colour.
#pragma once
#include "engine/optics/vec.h"
#include "engine/spectral/spectrum.h"

namespace lensproof {

/// K_m, lm/W: the luminous efficacy of radiation at 555 nm, where V(λ) peaks. The SI fixes 683 lm/W at 540 THz, which
/// is 555.016 nm in standard air, so K_m = 683 V(555 nm) / V(555.016 nm) (CIE International Lighting Vocabulary,
/// 17-21-092).
inline constexpr double kMaximumLuminousEfficacy = 683.002;

/// The CIE 1931 2° colour-matching functions, 360 to 830 nm, relative. `y_bar` is the luminous efficiency V(λ).
struct ColourMatching {
    Spectrum x_bar;
    Spectrum y_bar;
    Spectrum z_bar;
};

/// Reads them. Throws InputError where the project's own data is missing or damaged, as do all functions below that
/// read.
ColourMatching cie_1931();

/// V(λ), the photopic luminous efficiency: relative, 1 at 555 nm.
Spectrum photopic_efficiency();

/// X, Y, Z = K_m ∫ s (x̄, ȳ, z̄) dλ. Of a spectral radiance in W·m⁻²·sr⁻¹·nm⁻¹, Y is the luminance in cd/m²;
/// of a spectral irradiance in W·m⁻²·nm⁻¹, the illuminance in lx.
Vec3d tristimulus(const Spectrum& spectrum, const ColourMatching& observer);

/// (x, y) of X, Y, Z whose sum is positive.
Vec2d chromaticity(const Vec3d& xyz);

}  // namespace lensproof
