#include "engine/render/raw/raw_sensor.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/poisson_distribution.hpp>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/base/parallel.h"
#include "engine/render/sampling/sampler.h"
#include "engine/spectral/illuminant.h"

namespace lensproof::render {

namespace {

constexpr const char* kNoPattern = "none";
constexpr const char* kBilinear = "bilinear";
constexpr const char* kEdgeAware = "edge-aware";

/// The random numbers of one raw value: SplitMix64 (Steele, Lea, Flood, OOPSLA 2014) from a place that seed and value
/// tell. With 2⁶⁴ places, streams do not meet.
class ValueRandom {
  public:
    using result_type = std::uint64_t;
    static constexpr result_type min() { return 0; }
    static constexpr result_type max() { return std::numeric_limits<result_type>::max(); }

    ValueRandom(std::uint64_t seed, std::uint64_t value)
        : state_(sampler_detail::mixed(sampler_detail::mixed(seed ^ kOfSensors) + value)) {}

    result_type operator()() {
        const result_type number = sampler_detail::mixed(state_);
        state_ += 0x9e3779b97f4a7c15ULL;
        return number;
    }

  private:
    static constexpr std::uint64_t kOfSensors = 0x73656e736f72ULL;  // other numbers than the render's

    std::uint64_t state_;
};

/// With so many the chance of less than saturation is below exp(−400) (Chernoff).
double most_electrons(const RawSensor& sensor) {
    return 4.0 * electrons_at_saturation(sensor) + 1000.0 + 100.0 * sensor.read_noise_electrons;
}

std::uint16_t raw_value(const RawSensor& sensor, double value, int channel, ValueRandom& random) {
    const double mean = std::min(read_electrons(sensor, value, channel).mean, most_electrons(sensor));
    double electrons = 0.0;
    if (mean > 0.0) {  // by inversion below 10, else Hörmann's PTRD (1993): both exact
        electrons = static_cast<double>(boost::random::poisson_distribution<std::int64_t>(mean)(random));
    }
    electrons += boost::random::normal_distribution<double>(0.0, sensor.read_noise_electrons)(random);
    const double level = sensor.black_level_dn + dn_per_electron(sensor) * electrons;
    return static_cast<std::uint16_t>(std::lround(std::clamp(level, 0.0, 1.0 * sensor.white_level_dn)));
}

void read_levels(TomlTable& table, RawSensor& sensor) {
    sensor.bits = table.integer("bits", 8, 16);
    const int most = (1 << sensor.bits) - 1;
    sensor.white_level_dn = table.integer_or("white_level", most, 1, most);
    sensor.black_level_dn = table.integer_or("black_level", 1 << (sensor.bits - 5), 0, most);
    if (sensor.black_level_dn >= sensor.white_level_dn) {
        const std::string key = table.has("black_level") ? "black_level" : "white_level";
        table.fail(key, fmt::format("leaves a black level of {} and a white level of {}, expected black below white",
                                    sensor.black_level_dn, sensor.white_level_dn));
    }
}

void read_pattern(TomlTable& table, const RawCamera& camera, RawSensor& sensor) {
    const std::string pattern = table.choice("pattern", {"RGGB", "BGGR", "GRBG", "GBRG", kNoPattern});
    if (pattern == kNoPattern) {
        return;
    }
    if (sensor.channels != 3) {
        table.fail("pattern", fmt::format("is \"{}\", but the response \"{}\" has one channel: expected \"{}\"",
                                          pattern, camera.response, kNoPattern));
    }
    if (camera.width < 2 || camera.height < 2) {
        table.fail("pattern",
                   fmt::format("is \"{}\", but the picture has {} × {} pixels: expected two each way at least", pattern,
                               camera.width, camera.height));
    }
    sensor.pattern = pattern;
}

Vec3d read_neutral(TomlTable& table, const RawCamera& camera, int channels) {
    if (!table.has("neutral")) {
        return spectral::sensor_neutral(camera.response, spectral::illuminant(camera.white));
    }
    if (channels != 3) {
        table.fail("neutral",
                   fmt::format("is there, but the response \"{}\" has one channel: expected none", camera.response));
    }
    const std::vector<double> neutral = table.numbers("neutral", 3, {.min = 1e-3, .max = 1.0});
    if (std::ranges::max(neutral) != 1.0) {
        table.fail("neutral", fmt::format("is [{}], expected 1 for the largest", fmt::join(neutral, ", ")));
    }
    return {neutral[0], neutral[1], neutral[2]};
}

std::map<std::string, std::string> metadata_of(const RawSensor& sensor,
                                               const std::map<std::string, std::string>& film) {
    std::map<std::string, std::string> metadata = film;
    metadata.erase("lensproof:colourSpace");  // that of balanced channels
    metadata["lensproof:pattern"] = sensor.pattern.empty() ? kNoPattern : sensor.pattern;
    metadata["lensproof:bits"] = fmt::format("{}", sensor.bits);
    metadata["lensproof:blackLevel"] = fmt::format("{}", sensor.black_level_dn);
    metadata["lensproof:whiteLevel"] = fmt::format("{}", sensor.white_level_dn);
    metadata["lensproof:neutral"] =
        sensor.channels == 3 ? fmt::format("{} {} {}", sensor.neutral.x, sensor.neutral.y, sensor.neutral.z) : "1";
    metadata["lensproof:dnPerElectron"] = fmt::format("{}", dn_per_electron(sensor));
    metadata["lensproof:readNoise_electrons"] = fmt::format("{}", sensor.read_noise_electrons);
    return metadata;
}

}  // namespace

RawSensor read_raw_sensor(TomlTable& table, const RawCamera& camera) {
    RawSensor sensor;
    sensor.camera = camera;
    sensor.channels = static_cast<int>(spectral::sensor_channels(camera.response).size());
    read_pattern(table, camera, sensor);
    sensor.full_well_electrons = table.number("full_well_electrons", {.min = 1.0, .max = 1e9});
    sensor.read_noise_electrons = table.number("read_noise_electrons", {.min = 0.0, .max = 1e6});
    read_levels(table, sensor);
    sensor.base_iso = table.number_or("base_iso", sensor.base_iso, {.min = 1e-3, .max = 1e9});
    if (camera.exposure.iso < sensor.base_iso) {
        table.fail("base_iso", fmt::format("is {}, but the camera's iso is {}: a well that is full at 78/{} lx·s does "
                                           "not reach that of 78/{}; expected {} at most",
                                           sensor.base_iso, camera.exposure.iso, sensor.base_iso, camera.exposure.iso,
                                           camera.exposure.iso));
    }
    if (electrons_at_saturation(sensor) < 1.0) {
        table.fail("full_well_electrons",
                   fmt::format("is {}, which leaves {} of them at an iso of {}, expected 1 at "
                               "least",
                               sensor.full_well_electrons, electrons_at_saturation(sensor), camera.exposure.iso));
    }
    sensor.fill_factor = table.number_or("fill_factor", sensor.fill_factor, {.min = 1e-4, .max = 1.0});
    sensor.dark_current_electrons_per_s =
        table.number_or("dark_current_electrons_per_s", sensor.dark_current_electrons_per_s, {.min = 0.0, .max = 1e9});
    sensor.neutral = read_neutral(table, camera, sensor.channels);
    if (table.has("demosaicing") && table.choice("demosaicing", {kBilinear, kEdgeAware}) == kEdgeAware) {
        sensor.demosaicing = Demosaicing::edge_aware;
    }
    table.finish();
    return sensor;
}

std::string raw_sensor_text(const RawSensor& sensor) {
    const RawCamera& camera = sensor.camera;
    std::string text = fmt::format(
        "response = \"{}\"\nshutter_s = {}\niso = {}\nilluminant = \"{}\"\npixels = [{}, {}]\n[sensor]\n",
        camera.response, camera.exposure.time_s, camera.exposure.iso, camera.white, camera.width, camera.height);
    text += fmt::format(
        "pattern = \"{}\"\nfull_well_electrons = {}\nread_noise_electrons = {}\nbits = {}\nblack_level = {}\n"
        "white_level = {}\nbase_iso = {}\nfill_factor = {}\ndark_current_electrons_per_s = {}\ndemosaicing = \"{}\"\n",
        sensor.pattern.empty() ? kNoPattern : sensor.pattern, sensor.full_well_electrons, sensor.read_noise_electrons,
        sensor.bits, sensor.black_level_dn, sensor.white_level_dn, sensor.base_iso, sensor.fill_factor,
        sensor.dark_current_electrons_per_s, sensor.demosaicing == Demosaicing::edge_aware ? kEdgeAware : kBilinear);
    if (sensor.channels == 3) {
        text += fmt::format("neutral = [{}, {}, {}]\n", sensor.neutral.x, sensor.neutral.y, sensor.neutral.z);
    }
    return text;
}

RawSensor parse_raw_sensor(const std::string& text, const std::filesystem::path& name) {
    TomlTable top = TomlTable::parse(text, name);
    RawCamera camera;
    camera.response = top.choice("response", spectral::known_sensors());
    camera.exposure = {.time_s = top.number("shutter_s", kPositive), .iso = top.number("iso", kPositive)};
    camera.white = top.text("illuminant");
    const std::vector<double> pixels = top.numbers("pixels", 2, {.min = 1.0, .max = 1e5});
    camera.width = static_cast<int>(pixels[0]);
    camera.height = static_cast<int>(pixels[1]);
    TomlTable table = top.table("sensor");
    RawSensor sensor = read_raw_sensor(table, camera);
    top.finish();
    return sensor;
}

PixelFilter pixel_aperture(const RawSensor& sensor) {
    return PixelFilter::square(sensor.fill_factor);
}

double electrons_at_saturation(const RawSensor& sensor) {
    return sensor.full_well_electrons * sensor.base_iso / sensor.camera.exposure.iso;
}

double dn_per_electron(const RawSensor& sensor) {
    return (sensor.white_level_dn - sensor.black_level_dn) / electrons_at_saturation(sensor);
}

ReadElectrons read_electrons(const RawSensor& sensor, double value, int channel) {
    const std::array<double, 3> neutral = {sensor.neutral.x, sensor.neutral.y, sensor.neutral.z};
    const double of_light =
        value > 0.0 ? value * neutral[static_cast<std::size_t>(channel)] * electrons_at_saturation(sensor) : 0.0;
    const double mean = of_light + sensor.dark_current_electrons_per_s * sensor.camera.exposure.time_s;
    return {.mean = mean, .variance = mean + sensor.read_noise_electrons * sensor.read_noise_electrons};
}

RawImage expose(const RawSensor& sensor, const formats::Image& film, std::uint64_t seed, int threads) {
    const bool is_mosaic = !sensor.pattern.empty();
    const int channels = is_mosaic ? 1 : sensor.channels;
    RawImage raw{.mosaic = {.width = film.width,
                            .height = film.height,
                            .channels = channels,
                            .values = {},
                            .metadata = metadata_of(sensor, film.metadata)},
                 .pattern = sensor.pattern,
                 .bits = sensor.bits,
                 .black_level = sensor.black_level_dn,
                 .white_level = sensor.white_level_dn,
                 .neutral = sensor.neutral,
                 .demosaicing = sensor.demosaicing};
    raw.mosaic.values.resize(static_cast<std::size_t>(film.width) * film.height * channels);
    const auto read_row = [&](int y) {
        std::size_t value = static_cast<std::size_t>(y) * film.width * channels;
        for (int x = 0; x < film.width; ++x) {
            for (int layer = 0; layer < channels; ++layer, ++value) {
                const int channel = is_mosaic ? mosaic_channel(sensor.pattern, x, y) : layer;
                ValueRandom random(seed, value);
                raw.mosaic.values[value] = raw_value(sensor, film.at(x, y, channel), channel, random);
            }
        }
    };
    parallel_for(film.height, threads, read_row, [](int) {});
    return raw;
}

}  // namespace lensproof::render
