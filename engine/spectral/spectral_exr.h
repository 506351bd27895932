// engine/spectral/spectral_exr.h — names of channels and attributes in spectral EXR files.
//
// The layout is that of A. Fichet, R. Pacanowski, A. Wilkie, "An OpenEXR Layout for Spectral Images", JCGT 10(3), 2021:
// one channel a wavelength, in the layer S0 (S1 to S3 are the further Stokes components; T is reflectance or
// transmittance), and string attributes for the layout's version and the unit. Files are read and written elsewhere.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace lensproof::spectral {

/// What our layers hold. The unit that the layout foresees, "W.m^-2.sr^-1", is radiance; a film holds irradiance, and
/// our values are per nm, so the text says what they are. The authors' own library does not interpret it.
inline constexpr const char* kFilmIrradianceUnits = "W.m^-2.nm^-1";

/// "S0.550,000000nm": an unpolarised channel at `wavelength_nm`, with a decimal comma as dots separate layers. Six
/// decimals, as the authors' own library writes.
std::string spectral_channel_name(double wavelength_nm);

struct SpectralChannel {
    std::string layer;  // "S0" to "S3", or "T"
    double wavelength_nm = 0.0;
};

/// Reads any channel name that the layout allows: "S0.550nm", "S2.5,5e-1um", "T.545,08THz" (a frequency gives the
/// wavelength in vacuum). Nothing for every other name, such as "R" or a bi-spectral "T.400nm.550nm".
std::optional<SpectralChannel> parse_spectral_channel(std::string_view name);

/// The attributes of a spectral EXR whose S layers are in `units`.
std::map<std::string, std::string> spectral_attributes(const std::string& units);

}  // namespace lensproof::spectral
