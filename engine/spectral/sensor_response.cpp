#include "engine/spectral/sensor_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/input_error.h"
#include "engine/spectral/colour_matching.h"

namespace lensproof::spectral {

namespace {

/// Relative sensitivities, a channel's scale being free: the white balance sets it.
struct Sensitivities {
    std::vector<std::string> channels;
    std::vector<Spectrum> relative;
    bool is_balanced = false;  // for any white, by what the sensor is
};

/// The row of XYZ → RGB that is blind to the primaries `a` and `b`: up to scale, a row of the inverse of the matrix
/// whose columns are the primaries. (red, green, blue) is right-handed, so cyclic order gives positive scales.
Spectrum blind_to(const Vec3d& a, const Vec3d& b, const ColourMatching& observer) {
    const Vec3d row = cross(a, b);
    Spectrum sensitivity = observer.x_bar;
    for (std::size_t i = 0; i < sensitivity.value.size(); ++i) {
        sensitivity.value[i] =
            dot(row, Vec3d{observer.x_bar.value[i], observer.y_bar.value[i], observer.z_bar.value[i]});
    }
    return sensitivity;
}

Sensitivities colorimetric() {
    const ColourMatching observer = cie_1931();
    const auto& [red, green, blue] = kRec709Primaries;
    return {
        .channels = {"R", "G", "B"},
        .relative = {blind_to(green, blue, observer), blind_to(blue, red, observer), blind_to(red, green, observer)},
        .is_balanced = true};
}

Sensitivities measured_camera(const char* file) {
    return {.channels = {"R", "G", "B"}, .relative = read_spectra(spectral_data(file), {"red", "green", "blue"})};
}

Sensitivities nikon() {
    return measured_camera("camera-nikon-d5100.csv");
}

Sensitivities sigma() {
    return measured_camera("camera-sigma-sd1-merrill.csv");
}

Sensitivities photometer() {
    return {.channels = {"Y"}, .relative = {photopic_efficiency()}};
}

Sensitivities flat() {
    return {.channels = {"Y"}, .relative = {{.wavelength_nm = {400.0, 700.0}, .value = {1.0, 1.0}}}};
}

struct Sensor {
    const char* name;
    Sensitivities (*sensitivities)();
};

constexpr std::array<Sensor, 5> kSensors{{{"cie-1931", colorimetric},
                                          {"camera", nikon},
                                          {"camera-sigma-sd1-merrill", sigma},
                                          {"luminance", photometer},
                                          {"monochrome", flat}}};

Sensitivities sensitivities_of(const std::string& name) {
    for (const Sensor& sensor : kSensors) {
        if (sensor.name == name) {
            return sensor.sensitivities();
        }
    }
    throw InputError(
        fmt::format("sensor '{}' is not known: expected one of {}", name, fmt::join(known_sensors(), ", ")));
}

void require_positive(double value, const char* what, const char* unit) {
    if (!(value > 0.0 && std::isfinite(value))) {
        throw InputError(fmt::format("{} is {}{}: expected a positive number", what, value, unit));
    }
}

/// What white light gives in a channel, in its sensitivity's unit.
double white_value(const Sensitivities& sensitivities, std::size_t channel, const Spectrum& light,
                   const std::string& name, const Illuminant& white) {
    const double value = integral_of_product(light, sensitivities.relative[channel]);
    if (!(value > 0.0)) {
        throw InputError(
            fmt::format("sensor '{}' cannot be balanced to illuminant '{}': its channel {} does not see it", name,
                        white.name, sensitivities.channels[channel]));
    }
    return value;
}

}  // namespace

double saturation_exposure_lx_s(double iso) {
    return 78.0 / iso;
}

Vec3d SensorResponse::weights(double wavelength_nm) const {
    return {weight[0](wavelength_nm), weight[1](wavelength_nm), weight[2](wavelength_nm)};
}

Vec3d SensorResponse::values(const Spectrum& film_irradiance) const {
    return {integral_of_product(film_irradiance, weight[0]), integral_of_product(film_irradiance, weight[1]),
            integral_of_product(film_irradiance, weight[2])};
}

std::vector<std::string> known_sensors() {
    std::vector<std::string> names;
    names.reserve(kSensors.size());
    for (const Sensor& sensor : kSensors) {
        names.emplace_back(sensor.name);
    }
    return names;
}

SensorResponse sensor_response(const std::string& name, const Exposure& exposure, const Illuminant& white) {
    require_positive(exposure.time_s, "exposure time", " s");
    require_positive(exposure.iso, "ISO", "");
    Sensitivities sensitivities = sensitivities_of(name);
    const Spectrum saturating = irradiance_of(white, saturation_exposure_lx_s(exposure.iso) / exposure.time_s);
    SensorResponse response{.name = name, .channels = sensitivities.channels, .weight = {}};
    for (std::size_t channel = 0; channel < response.channels.size(); ++channel) {
        const double of_white = white_value(sensitivities, channel, saturating, name, white);
        response.weight[channel] = 1.0 / of_white * std::move(sensitivities.relative[channel]);
    }
    return response;
}

std::optional<RgbSpace> rgb_space(const std::string& name, const Illuminant& white) {
    if (name != "cie-1931") {
        return std::nullopt;
    }
    const auto& [red, green, blue] = kRec709Primaries;
    return RgbSpace{.red = {red.x, red.y},
                    .green = {green.x, green.y},
                    .blue = {blue.x, blue.y},
                    .white = chromaticity(tristimulus(white.relative, cie_1931()))};
}

std::vector<std::string> sensor_channels(const std::string& name) {
    return sensitivities_of(name).channels;
}

Vec3d sensor_neutral(const std::string& name, const Illuminant& white) {
    const Sensitivities sensitivities = sensitivities_of(name);
    std::array<double, 3> value{};
    for (std::size_t channel = 0; channel < sensitivities.channels.size(); ++channel) {
        const double of_white = white_value(sensitivities, channel, white.relative, name, white);
        value[channel] = sensitivities.is_balanced ? 1.0 : of_white;
    }
    const double largest = *std::ranges::max_element(value);
    return {value[0] / largest, value[1] / largest, value[2] / largest};
}

std::vector<Vec3d> stratum_weights(const SensorResponse& sensor, const WavelengthStrata& strata,
                                   const Illuminant& light) {
    std::vector<Vec3d> weights(static_cast<std::size_t>(strata.count));
    for (int i = 0; i < strata.count; ++i) {
        const double at_midpoint = light.relative(strata.midpoint(i));
        if (at_midpoint > 0.0) {
            const Spectrum inside = clipped(light.relative, strata.at(i, 0.0), strata.at(i, 1.0));
            weights[static_cast<std::size_t>(i)] = 1.0 / (at_midpoint * strata.width_nm()) * sensor.values(inside);
        }
    }
    return weights;
}

}  // namespace lensproof::spectral
