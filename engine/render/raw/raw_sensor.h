// engine/render/raw/raw_sensor.h — from the light on the film to the integers in a camera's raw file.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "engine/base/toml.h"
#include "engine/formats/image/image.h"
#include "engine/render/raw/raw_image.h"
#include "engine/render/sampling/pixel_filter.h"
#include "engine/spectral/sensor_response.h"

namespace lensproof::render {

/// What the camera says that the sensor is in.
struct RawCamera {
    std::string response;
    spectral::Exposure exposure;
    std::string white;  // the illuminant that the film is balanced to
    int width = 0;      // px
    int height = 0;
};

/// The electronics behind a film.
///
/// The film's channel c holds v_c, in which light of the scene's white and of the luminous exposure 78 lx·s / ISO gives
/// 1 (`SensorResponse`). A pixel behind that filter collects on average
///     μ = v_c · neutral_c · N_sat + dark current · shutter,     N_sat = full well · base ISO / ISO,
/// electrons: the full well is what saturates the raw at base ISO, where 78 lx·s / base ISO fills it (ISO 12232:2019,
/// saturation-based speed), so that a higher ISO spreads the converter's range over fewer electrons; what the well
/// holds beyond is not seen. The raw value is
///     black level + K · (Poisson(μ) + read noise · Gauss),      K = (white level − black level) / N_sat,
/// rounded, and cut to 0 … white level. Negative light, which "cie-1931" has for strong colours, is none.
///
/// The fill factor does nothing to the number of electrons: ISO is defined by the exposure that saturates, whatever
/// part of a pixel it falls on. It makes the picture sharper, and has to act on the film: `pixel_aperture`. Under
/// micro-lenses, which bring the whole pixel's light to its sensitive part, it is 1.
struct RawSensor {
    std::string pattern;  // colours of the pixels (0, 0), (1, 0), (0, 1), (1, 1), say "RGGB"; empty: each pixel
                          // measures every channel, as behind no filter, in a stack of layers or by three chips
    double full_well_electrons = 0.0;
    double read_noise_electrons = 0.0;          // standard deviation, at this ISO
    double dark_current_electrons_per_s = 0.0;  // its noise stays in the raw, and so does its mean
    double base_iso = 100.0;
    int bits = 14;  // of the converter: levels are below 2^bits
    int black_level_dn = 0;
    int white_level_dn = 0;
    double fill_factor = 1.0;  // fraction of a pixel's area that collects light, a centred square
    Demosaicing demosaicing = Demosaicing::bilinear;

    // What camera and light bring with them.
    RawCamera camera;
    int channels = 3;  // of its response
    Vec3d neutral;     // what white gives in each, the largest 1 (`sensor_neutral`)
};

/// Reads a table [sensor]:
///   pattern                       "RGGB", "BGGR", "GRBG", "GBRG" or "none"
///   full_well_electrons           at base_iso; 1 to 1e9, and 1 at least at the camera's ISO
///   read_noise_electrons          0 to 1e6
///   bits                          of the converter, 8 to 16
///   black_level                   raw value without light; default 2^(bits − 5)
///   white_level                   raw value at saturation; default 2^bits − 1
///   base_iso                      default 100; the camera's ISO is no lower
///   fill_factor                   over 0, to 1; default 1
///   dark_current_electrons_per_s  default 0
///   neutral                       what white gives in R, G, B before balance, the largest 1, as a raw photo's own file
///                                 says; default: as the response's data have it, `sensor_neutral`
///   demosaicing                   "bilinear", the default, or "edge-aware"
/// Throws InputError naming file, line and key.
RawSensor read_raw_sensor(TomlTable& table, const RawCamera& camera);

/// The sensor and its camera as a text that goes along with a film, and the sensor of such a text. `name` stands for
/// its file in messages. Throws InputError.
std::string raw_sensor_text(const RawSensor& sensor);
RawSensor parse_raw_sensor(const std::string& text, const std::filesystem::path& name);

/// What a pixel of the film has to see for the sensor to be behind it: the film's filter.
PixelFilter pixel_aperture(const RawSensor& sensor);

/// N_sat and K above.
double electrons_at_saturation(const RawSensor& sensor);
double dn_per_electron(const RawSensor& sensor);

/// The electrons that light makes and the variance of what is read of them, both on average, where the film's channel
/// (0 to 2) holds `value`.
struct ReadElectrons {
    double mean = 0.0;      // μ above
    double variance = 0.0;  // μ + read noise²
};
ReadElectrons read_electrons(const RawSensor& sensor, double value, int channel);

/// The raw of a film's R, G, B (of a sensor with one channel, the first). Each value's noise depends on (seed, pixel,
/// channel) alone. `film`'s metadata go along; sensor, levels and gain are added to them.
RawImage expose(const RawSensor& sensor, const formats::Image& film, std::uint64_t seed, int threads = 0);

}  // namespace lensproof::render
