// engine/spectral/colour_matching.h — what the CIE's standard observer sees of a spectrum: luminance and colour.
#pragma once
#include <array>

#include "engine/base/vec.h"
#include "engine/spectral/spectrum.h"

namespace lensproof::spectral {

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

/// The x, y, z chromaticities of the Rec. 709 primaries, red, green and blue (ITU-R BT.709-6; the same in IEC
/// 61966-2-1, sRGB).
inline constexpr std::array<Vec3d, 3> kRec709Primaries{Vec3d{0.640, 0.330, 0.030}, Vec3d{0.300, 0.600, 0.100},
                                                       Vec3d{0.150, 0.060, 0.790}};

/// X, Y, Z of each Rec. 709 primary at full strength, all three of which together make X, Y, Z = `white`.
std::array<Vec3d, 3> rec709_primaries(const Vec3d& white);

/// (x, y) of X, Y, Z whose sum is positive.
Vec2d chromaticity(const Vec3d& xyz);

/// CIE 1976 L*, a*, b* of X, Y, Z as seen against `white` (ISO/CIE 11664-4:2019).
Vec3d cielab(const Vec3d& xyz, const Vec3d& white);

}  // namespace lensproof::spectral
