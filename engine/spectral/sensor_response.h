// engine/spectral/sensor_response.h — from the light on the film to the numbers that a camera stores.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/vec.h"
#include "engine/spectral/illuminant.h"
#include "engine/spectral/spectrum.h"
#include "engine/spectral/wavelengths.h"

namespace lensproof::spectral {

struct Exposure {
    double time_s = 0.01;
    double iso = 100.0;
};

/// The luminous exposure that saturates a sensor, H_sat = 78 / S lx·s (ISO 12232:2019, saturation-based speed).
double saturation_exposure_lx_s(double iso);

/// A sensor at an exposure. A film irradiance E in W·m⁻²·nm⁻¹ gives channel c the linear value
///     v_c = ∫ E(λ) w_c(λ) dλ,
/// in which 1 is saturation. Exposure time, ISO, white balance and colour matrix are all within w.
struct SensorResponse {
    std::string name;
    std::vector<std::string> channels;  // "R", "G", "B", or "Y"
    std::array<Spectrum, 3> weight;     // w_c in m²/W, in the order of `channels`; empty where there is no channel

    /// (w_0, w_1, w_2) at one wavelength, m²/W: a renderer sums E(λ) · weights(λ) · Δλ.
    [[nodiscard]] Vec3d weights(double wavelength_nm) const;

    /// v for a film irradiance in W·m⁻²·nm⁻¹, integrated exactly.
    [[nodiscard]] Vec3d values(const Spectrum& film_irradiance) const;
};

/// The names that `sensor_response` takes:
///   "cie-1931"    R, G, B in the linear Rec. 709 (sRGB, IEC 61966-2-1) primaries, by the CIE 1931 2° observer. Colours
///                 outside the primaries' triangle, as all spectral ones are, give negative values, which stay.
///   "camera"      R, G, B of a Nikon D5100 as measured at NPL (Darrodi et al. 2015), 380 to 780 nm: the camera's own
///                 colours, without a matrix to a display's.
///   "camera-sigma-sd1-merrill"  R, G, B of a Sigma SD1 Merrill, whose layers lie above each other (Foveon), as
///   measured
///                 there too, 400 to 680 nm: broad, overlapping bands.
///   "luminance"   Y, by V(λ): a photometer.
///   "monochrome"  Y, the same for each watt from 400 to 700 nm and none beyond: a sensor behind an ideal UV/IR filter.
std::vector<std::string> known_sensors();

/// The sensor called `name`, balanced to `white`: light of that spectrum and an illuminance of H_sat / time gives
/// exactly 1 in each channel. With D65, "cie-1931" is then linear sRGB, its white being D65 as tabulated (IEC 61966-2-1
/// rounds it to four digits). With another white it is the RGB space of the Rec. 709 primaries and that white; no
/// further adaptation. A scene lit by `white` is thus exposed as a light meter would say.
/// Throws InputError for an unknown name (listing those known), for a time or ISO that is not
/// positive, and for a white that a channel does not see.
SensorResponse sensor_response(const std::string& name, const Exposure& exposure, const Illuminant& white);

/// The channels of the sensor called `name`.
std::vector<std::string> sensor_channels(const std::string& name);

/// What light of the spectrum `white` gives in the channels of the sensor called `name` before any balance, the largest
/// 1; the white balance's multipliers are one over each. A measured camera's is by its data, in which each channel's
/// peak is 1: the measurement does not tell them apart in height. For "cie-1931", whose channels are those of a
/// balanced display, each is 1. Where there is no channel it is 0. Throws as above.
Vec3d sensor_neutral(const std::string& name, const Illuminant& white);

/// CIE 1931 chromaticities of a linear RGB space.
struct RgbSpace {
    Vec2d red;
    Vec2d green;
    Vec2d blue;
    Vec2d white;
};

/// The space of the R, G, B of the sensor called `name`, balanced to `white`; nothing for those whose colours are their
/// own.
std::optional<RgbSpace> rgb_space(const std::string& name, const Illuminant& white);

/// For a renderer that traces one wavelength, the midpoint, for each stratum: the weights W_i, m²/W, in
///     v = Σ_i E(midpoint_i) · W_i · width,     W_i = ∫_i L w dλ / (L(midpoint_i) · width),
/// where L is `light`, the scene's illuminant. However few the strata, this is exact where E = const · L (a grey scene
/// in white light stays white), and errs only by how the rest of E, say reflectance and transmittance, bends within
/// one. Plain weights at 16 midpoints are off by 1 %. What lies outside the strata's range does not count; where the
/// light is zero at a midpoint, so is W_i.
std::vector<Vec3d> stratum_weights(const SensorResponse& sensor, const WavelengthStrata& strata,
                                   const Illuminant& light);

}  // namespace lensproof::spectral
