#include "engine/render/metering.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/render/camera/camera.h"
#include "tests/complaint.h"

namespace lensproof::render::metering_test {

SceneSetup setup(const std::string& exposure, double luminance_cd_m2, const std::string& model = "pinhole") {
    return parse_scene_setup(fmt::format(R"(
[camera]
model = "{}"
focal_length_mm = 500.0
f_number = 4.0
focus_distance_mm = inf
position_mm = [0.0, 0.0, 0.0]
look_at_mm = [0.0, 0.0, 1000.0]
sensor_mm = [36.0, 24.0]
pixels = [300, 200]
{}
response = "cie-1931"
[render]
layers = 8
[[lights]]
kind = "environment"
luminance_cd_m2 = {}
)",
                                         model, exposure, luminance_cd_m2),
                             "sky.toml");
}

double metered(SceneSetup scene, int threads = 0) {
    EXPECT_TRUE(meter(scene, Cache(), threads));
    EXPECT_FALSE(scene.camera.is_exposure_automatic);
    return scene.camera.exposure.time_s;
}

// An even sky of L cd/m² lights the film by π L / (4 N²), 0.2 % less in the corners of a long lens; 0.18 of the
// saturation, 78 / ISO lx·s, then takes 0.18 · 78 · 4 N² / (ISO π L), here in thirds of a stop.
TEST(Metering, MakesAnEvenSkyMiddleGrey) {
    for (const double luminance : {0.1, 5000.0}) {
        for (const double iso : {100.0, 800.0}) {
            const double exact = kMiddleGrey * 78.0 * 4.0 * 16.0 / (iso * std::numbers::pi * luminance);
            const double third_stops = std::round(3.0 * std::log2(exact));
            EXPECT_EQ(metered(setup(fmt::format("iso = {}", iso), luminance)), std::exp2(third_stops / 3.0));
        }
    }
    EXPECT_EQ(metered(setup("", 40.0)), metered(setup("exposure = \"auto\"\niso = 100.0", 40.0)));
}

TEST(Metering, IsTheSameForThreadsAndModels) {
    const double one = metered(setup("", 40.0), 1);
    EXPECT_EQ(metered(setup("", 40.0), 3), one);
    EXPECT_EQ(metered(setup("", 40.0, "thin-lens")), one);
}

TEST(Metering, LeavesWhatIsStated) {
    SceneSetup stated = setup("shutter_s = 0.02\niso = 200.0", 40.0);
    EXPECT_FALSE(meter(stated, Cache(), 1));
    EXPECT_EQ(stated.camera.exposure.time_s, 0.02);
    EXPECT_EQ(stated.camera.exposure.iso, 200.0);
    EXPECT_NO_THROW(expect_stated_exposure(stated, "sky.toml"));
    EXPECT_TRUE(says(complaint_about([] { setup("shutter_s = 0.02\niso = 200.0\nexposure = \"auto\"", 40.0); }),
                     "exposure: stands beside shutter_s"));
    EXPECT_TRUE(says(complaint_about([] { setup("exposure = \"bright\"", 40.0); }), "auto"));
    EXPECT_TRUE(says(complaint_about([] { expect_stated_exposure(setup("", 40.0), "sky.toml"); }),
                     "sky.toml: camera: its exposure is automatic"));
}

// A lamp behind the camera lights nothing that it sees.
TEST(Metering, RefusesTheDark) {
    SceneSetup dark = parse_scene_setup(R"(
[camera]
model = "pinhole"
focal_length_mm = 50.0
f_number = 4.0
focus_distance_mm = inf
position_mm = [0.0, 0.0, 0.0]
look_at_mm = [0.0, 0.0, 1000.0]
sensor_mm = [36.0, 24.0]
pixels = [30, 20]
response = "cie-1931"
[[lights]]
kind = "sphere"
position_mm = [0.0, 0.0, -1000.0]
radius_mm = 10.0
luminance_cd_m2 = 100.0
)",
                                        "dark.toml");
    EXPECT_TRUE(says(complaint_about([&] { meter(dark, Cache(), 1); }), "no light is seen"));
}

}  // namespace lensproof::render::metering_test
