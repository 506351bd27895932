#include "engine/spectral/sensor_response.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "engine/base/input_error.h"
#include "engine/spectral/colour_matching.h"
#include "engine/spectral/wavelengths.h"
#include "tests/complaint.h"

namespace lensproof::spectral::sensor_response_test {

constexpr Exposure kExposure{.time_s = 0.004, .iso = 200.0};

// Sums of some 1000 terms, divided once: 1e-13.
constexpr double kRounding = 1e-13;

/// What `sensor` makes of `light` at the luminous exposure that saturates by ISO 12232: 78/ISO lx·s.
Vec3d at_saturation(const SensorResponse& sensor, const Illuminant& light) {
    return sensor.values(irradiance_of(light, 78.0 / kExposure.iso / kExposure.time_s));
}

TEST(SensorResponse, WhiteSaturatesEachChannelAt78OverIsoLuxSeconds) {
    for (const std::string& name : known_sensors()) {
        for (const char* white : {"D65", "A", "blackbody:5500", "E"}) {
            const SensorResponse sensor = sensor_response(name, kExposure, illuminant(white));
            const Vec3d values = at_saturation(sensor, illuminant(white));
            EXPECT_NEAR(values.x, 1.0, kRounding) << name << " " << white;
            EXPECT_NEAR(values.y, sensor.channels.size() == 3 ? 1.0 : 0.0, kRounding) << name << " " << white;
            EXPECT_NEAR(values.z, sensor.channels.size() == 3 ? 1.0 : 0.0, kRounding) << name << " " << white;
        }
    }
}

TEST(SensorResponse, ValuesGrowWithTimeAndIso) {
    for (const std::string& name : known_sensors()) {
        const double once = sensor_response(name, {.time_s = 0.01, .iso = 100.0}, illuminant("D65")).weights(550.0).x;
        const double six_times =
            sensor_response(name, {.time_s = 0.02, .iso = 300.0}, illuminant("D65")).weights(550.0).x;
        EXPECT_NEAR(six_times / once, 6.0, 6.0 * kRounding) << name;
    }
}

// A photometer reads lux whatever the light is. One watt per m² of 555 nm is 683.002 lx: the weight there is
// 683.002 lm/W · t · ISO / 78 lx·s.
TEST(SensorResponse, LuminanceIsAPhotometer) {
    const SensorResponse sensor = sensor_response("luminance", kExposure, illuminant("D65"));
    EXPECT_EQ(sensor.channels, std::vector<std::string>{"Y"});
    EXPECT_NEAR(at_saturation(sensor, illuminant("A")).x, 1.0, kRounding);
    const double expected = 683.002 * 0.004 * 200.0 / 78.0;
    EXPECT_NEAR(sensor.weights(555.0).x, expected, expected * kRounding);
    EXPECT_EQ(sensor.weights(555.0).y, 0.0);
}

TEST(SensorResponse, MonochromeCountsWattsOfVisibleLight) {
    const SensorResponse sensor = sensor_response("monochrome", kExposure, illuminant("D65"));
    EXPECT_EQ(sensor.weights(400.0).x, sensor.weights(700.0).x);
    EXPECT_EQ(sensor.weights(399.0).x, 0.0);
    EXPECT_EQ(sensor.weights(701.0).x, 0.0);
}

// IEC 61966-2-1 gives XYZ → linear sRGB with four decimals, for a white of (0.3127, 0.3290). Rounding moves a value by
// up to 5e-5 (x̄ + ȳ + z̄); the white, 2e-5 and 3e-5 from the tabulated D65, moves Z by 2e-4 and through the balance a
// channel by as much.
TEST(SensorResponse, Cie1931IsLinearSrgb) {
    const SensorResponse sensor = sensor_response("cie-1931", kExposure, illuminant("D65"));
    const ColourMatching observer = cie_1931();
    const double scale = 683.002 * 0.004 * 200.0 / 78.0;
    for (int wavelength_nm = 380; wavelength_nm <= 780; wavelength_nm += 10) {
        const double x = observer.x_bar(wavelength_nm);
        const double y = observer.y_bar(wavelength_nm);
        const double z = observer.z_bar(wavelength_nm);
        const Vec3d rgb = 1.0 / scale * sensor.weights(wavelength_nm);
        const double tolerance = (5e-5 + 3e-4) * (x + y + z);
        EXPECT_NEAR(rgb.x, 3.2406 * x - 1.5372 * y - 0.4986 * z, tolerance) << wavelength_nm;
        EXPECT_NEAR(rgb.y, -0.9689 * x + 1.8758 * y + 0.0415 * z, tolerance) << wavelength_nm;
        EXPECT_NEAR(rgb.z, 0.0557 * x - 0.2040 * y + 1.0570 * z, tolerance) << wavelength_nm;
    }
}

// No spectral colour lies within a triangle inside the spectral locus, so each of them has a negative component.
TEST(SensorResponse, SpectralColoursLieOutsideSrgb) {
    const SensorResponse sensor = sensor_response("cie-1931", kExposure, illuminant("D65"));
    for (int wavelength_nm = 390; wavelength_nm <= 690; wavelength_nm += 5) {
        const Vec3d rgb = sensor.weights(wavelength_nm);
        EXPECT_LT(std::min({rgb.x, rgb.y, rgb.z}), 0.0) << wavelength_nm;
    }
}

// Raw D65 responses of the D5100, R : G : B = 0.58136155 : 1 : 0.85270666, by colour-science 0.4.7 as 5 nm sums over
// 380 to 780 nm. Its curves peak at 1 at 595, 530 and 460 nm, so there the balanced weights are in inverse proportion.
// Sum against exact product: ∫ of lines' product − sum = −Σ Δa Δb h/6, below 2e-3 of the total for such curves.
TEST(SensorResponse, CameraIsBalancedToItsWhite) {
    const SensorResponse sensor = sensor_response("camera", kExposure, illuminant("D65"));
    const double red = sensor.weights(595.0).x;
    const double green = sensor.weights(530.0).y;
    const double blue = sensor.weights(460.0).z;
    EXPECT_NEAR(green / red, 0.58136155, 2e-3);
    EXPECT_NEAR(green / blue, 0.85270666, 2e-3);
    EXPECT_EQ(sensor.weights(800.0), (Vec3d{}));
    EXPECT_EQ(sensor.channels, (std::vector<std::string>{"R", "G", "B"}));
}

// Strata over all that a sensor sees hold its white exactly, however few they are: ∫ over the parts is ∫ over the
// whole.
TEST(SensorResponse, StratumWeightsKeepWhiteWhite) {
    const Illuminant d65 = illuminant("D65");
    const Spectrum saturating = irradiance_of(d65, 78.0 / kExposure.iso / kExposure.time_s);
    for (const std::string& name : known_sensors()) {
        const SensorResponse sensor = sensor_response(name, kExposure, d65);
        for (const int count : {1, 7, 16}) {
            const WavelengthStrata strata = wavelength_strata(360.0, 830.0, count);
            const std::vector<Vec3d> weights = stratum_weights(sensor, strata, d65);
            Vec3d value;
            for (int i = 0; i < count; ++i) {
                value = value + saturating(strata.midpoint(i)) * strata.width_nm() * weights[i];
            }
            EXPECT_NEAR(value.x, 1.0, kRounding) << name << " " << count;
            EXPECT_NEAR(value.z, sensor.channels.size() == 3 ? 1.0 : 0.0, kRounding) << name << " " << count;
        }
    }
}

// As strata narrow, their weights become those of the wavelength: within 1 nm nothing bends by more than 1 %.
TEST(SensorResponse, NarrowStrataHaveTheWeightsOfTheirWavelength) {
    const SensorResponse sensor = sensor_response("camera", kExposure, illuminant("D65"));
    const WavelengthStrata strata = wavelength_strata(450.0, 650.0, 200);
    const std::vector<Vec3d> weights = stratum_weights(sensor, strata, illuminant("A"));
    const double largest = sensor.weights(595.0).x;
    for (int i = 0; i < strata.count; ++i) {
        EXPECT_NEAR(weights[i].x, sensor.weights(strata.midpoint(i)).x, 0.01 * largest);
        EXPECT_NEAR(weights[i].y, sensor.weights(strata.midpoint(i)).y, 0.01 * largest);
    }
}

// Beyond the tables there is no light, and no weight to divide by it.
TEST(SensorResponse, StrataWithoutLightWeighNothing) {
    const SensorResponse sensor = sensor_response("cie-1931", kExposure, illuminant("D65"));
    EXPECT_EQ(stratum_weights(sensor, wavelength_strata(840.0, 900.0, 1), illuminant("D65")).front(), (Vec3d{}));
}

TEST(SensorResponse, WrongInputsAreRefused) {
    const Illuminant d65 = illuminant("D65");
    EXPECT_THROW(sensor_response("camera", {.time_s = 0.0, .iso = 100.0}, d65), InputError);
    EXPECT_THROW(sensor_response("camera", {.time_s = 1.0, .iso = -1.0}, d65), InputError);
    const Illuminant red{.name = "laser", .relative = {.wavelength_nm = {720.0, 740.0}, .value = {1.0, 1.0}}};
    EXPECT_THROW(sensor_response("monochrome", kExposure, red), InputError);
    EXPECT_EQ(complaint_about([&] { sensor_response("film", kExposure, d65); }),
              "sensor 'film' is not known: expected one of cie-1931, camera, camera-sigma-sd1-merrill, luminance, "
              "monochrome");
}

}  // namespace lensproof::spectral::sensor_response_test
