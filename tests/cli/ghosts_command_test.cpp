// tests/cli/ghosts_command_test.cpp — `lensproof ghosts` as a user meets it: its JSON, its table, its picture, what it
// refuses.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::ghosts_command_test {

using Json = nlohmann::json;

// Two surfaces of glass make one ghost; its paraxial marginal ray is that of the folded singlet, R₁ = 50, R₂ = −50,
// t = 5 (BK7 at d: 1.5168): refracted, reflected twice and refracted again, by hand below.
TEST(GhostsCommand, ReportsWhatTheContractSays) {
    const Workplace place;
    place.file("singlet.toml", kSinglet);
    const Json result = place.json({"ghosts", "singlet.toml", "--wavelengths", "587.5618", "--image-circle", "40"});
    EXPECT_EQ(result["lens"], "singlet");
    EXPECT_EQ(result["source_deg"], 0.0);
    EXPECT_EQ(result["skipped_energy_bound"], 0.0);
    ASSERT_EQ(result["ghosts"].size(), 1U);
    const Json& ghost = result["ghosts"][0];
    EXPECT_EQ(ghost["surfaces"], Json({2, 1}));
    const double n = 1.5168;
    const double c = 1.0 / 50.0;
    double y = 1.0;
    double u = -c * (n - 1.0) / n * y;
    y += 5.0 * u;
    u = -u + 2.0 * c * y;  // off a surface of curvature −c
    y -= 5.0 * u;
    u = -u - 2.0 * c * y;
    y += 5.0 * u;
    u = n * u + (1.0 - n) * c * y;
    const Json& paraxial = ghost["paraxial"];
    EXPECT_NEAR(paraxial["efl_mm"].get<double>(), -1.0 / u, 1e-3);
    EXPECT_NEAR(paraxial["focus_mm"].get<double>(), -y / u - 45.0, 1e-3);
    EXPECT_GT(std::abs(paraxial["marginal_ray_height_mm"].get<double>()), 1.0);
    EXPECT_TRUE(paraxial["chief_ray_height_mm"].is_number());
    EXPECT_TRUE(paraxial["pupil_mm"].is_number());
    EXPECT_TRUE(paraxial["f_number"].is_number());
    // R² T² of the light, and what the image circle leaves of it.
    const double r = std::pow((n - 1.0) / (n + 1.0), 2);
    EXPECT_LT(ghost["energy"].get<double>(), 1.2 * r * r);
    EXPECT_GT(ghost["energy"].get<double>(), 0.01 * r * r);
    EXPECT_LT(ghost["energy_standard_error"].get<double>(), 0.01 * ghost["energy"].get<double>());
    EXPECT_GE(ghost["landed_share"].get<double>(), 0.8);
    EXPECT_LT(std::hypot(ghost["centroid_mm"][0].get<double>(), ghost["centroid_mm"][1].get<double>()), 0.1);
    EXPECT_GT(ghost["rms_radius_mm"].get<double>(), 1.0);
    EXPECT_LT(ghost["peak_over_image"].get<double>(), 1e-2);
    ASSERT_EQ(result["surfaces"].size(), 2U);
    EXPECT_NEAR(result["surfaces"][0]["gone_if_perfect"].get<double>(), 1.0, 1e-12);
}

TEST(GhostsCommand, ListsTheStrongestAndTheSensor) {
    const Workplace place;
    place.file("singlet.toml", kSinglet);
    const std::vector<std::string> command{"ghosts",   "singlet.toml",   "--wavelengths",
                                           "587.5618", "--image-circle", "40"};
    std::vector<std::string> with_sensor = command;
    with_sensor.insert(with_sensor.end(), {"--sensor-reflectance", "0.2", "--blade-reflectance", "0.05"});
    const Json all = place.json(with_sensor);
    ASSERT_EQ(all["ghosts"].size(), 6U);
    EXPECT_EQ(all["ghosts"][0]["surfaces"][0], "image");
    for (std::size_t i = 1; i < 6; ++i) {
        EXPECT_GE(all["ghosts"][i - 1]["energy"].get<double>(), all["ghosts"][i]["energy"].get<double>());
    }
    with_sensor.insert(with_sensor.end(), {"--strongest", "2", "--reflections", "4", "--plot", "ghosts.svg"});
    const Json two = place.json(with_sensor);
    EXPECT_EQ(two["ghosts"].size(), 2U);
    EXPECT_EQ(two["ghosts"][0], all["ghosts"][0]);
    EXPECT_GT(two["skipped_energy_bound"].get<double>(), 0.0);
    EXPECT_TRUE(says(place.content("ghosts.svg"), "reflected at image,"));
    const std::string text = place.run(command).out;
    EXPECT_TRUE(says(text, "2,1"));
    EXPECT_TRUE(says(text, "Which surface to coat"));
}

// A part's irradiance inside the image circle, over its pixels, is the row's energy of the light that enters the pupil:
// pixels that the circle cuts are 4 in 100, of which its half counts wrongly at most. The sum is that of its parts.
TEST(GhostsCommand, DrawsWhatItLists) {
    const Workplace place;
    place.file("singlet.toml", kSinglet);
    const Json result =
        place.json({"ghosts", "singlet.toml", "--wavelengths", "587.5618,486.1327,656.2725", "--image-circle", "20",
                    "--source-deg", "3", "--image", "ghosts.exr", "--pixels", "120,120", "--sensor-mm", "24,24",
                    "--strongest", "3", "--sensor-reflectance", "0.1"});
    const Json lens = place.json({"analyze", "singlet.toml", "--wavelengths", "587.5618"});
    const double diameter = lens["paraxial"]["entrance_pupil_diameter_mm"].get<double>();
    const double pupil = std::numbers::pi / 4.0 * diameter * diameter * std::cos(3.0 * std::numbers::pi / 180.0);
    const auto file = OIIO::ImageInput::open((place.path() / "ghosts.exr").string());
    ASSERT_NE(file, nullptr);
    constexpr std::size_t kAcross = 120;
    constexpr std::size_t kPixels = kAcross * kAcross;
    std::vector<double> left(kPixels);
    for (int part = 0; part < 4; ++part) {
        const OIIO::ImageSpec spec = file->spec(part);
        ASSERT_EQ(spec.nchannels, 6);
        std::vector<float> values(kPixels * 6);
        ASSERT_TRUE(file->read_image(part, 0, 0, 6, OIIO::TypeDesc::FLOAT, values.data()));
        const auto yellow = static_cast<std::size_t>(spec.channelindex("S0.587,561800nm"));
        double in_circle = 0.0;
        for (std::size_t i = 0; i < kPixels; ++i) {
            const double value = values[6 * i + yellow];
            left[i] += part == 0 ? value : -value;
            const std::size_t row = i / kAcross;
            const double x = (static_cast<double>(i % kAcross) - 59.5) * 0.2;
            const double y = (static_cast<double>(row) - 59.5) * 0.2;
            in_circle += std::hypot(x, y) < 10.0 ? value * 0.2 * 0.2 / pupil : 0.0;
        }
        if (part == 0) {
            EXPECT_EQ(spec.get_string_attribute("oiio:subimagename"), "ghosts");
            EXPECT_EQ(Json::parse(spec.get_string_attribute("lensproof:ghosts").c_str())["source_deg"], 3.0);
            EXPECT_NEAR(in_circle, result["energy"].get<double>(), 0.03 * in_circle);
            continue;
        }
        const Json& row = result["ghosts"][static_cast<std::size_t>(part) - 1];
        EXPECT_EQ(Json::parse(spec.get_string_attribute("lensproof:ghost").c_str()), row);
        EXPECT_NEAR(in_circle, row["energy"].get<double>(), 0.03 * in_circle);
    }
    for (const double value : left) {
        ASSERT_NEAR(value, 0.0, 1e-5);  // irradiances of some 0.01, as floats
    }
}

TEST(GhostsCommand, RefusesWhatItCannotUse) {
    const Workplace place;
    place.file("singlet.toml", kSinglet);
    for (const auto& [more, word] : {std::pair{std::vector<std::string>{"--source-deg", "90"}, "--source-deg"},
                                     {{"--source-deg", "up"}, "--source-deg"},
                                     {{"--reflections", "3"}, "--reflections"},
                                     {{"--strongest", "0"}, "--strongest"},
                                     {{"--tolerance", "0"}, "--tolerance"},
                                     {{"--sensor-reflectance", "-0.1"}, "--sensor-reflectance"},
                                     {{"--blade-reflectance", "2"}, "--blade-reflectance"},
                                     {{"--image-circle", "0"}, "--image-circle"},
                                     {{"--wavelengths", "100"}, "100 nm"},
                                     {{"--plot", "nowhere/"}, "nowhere"},
                                     {{"--image", "nowhere/"}, "nowhere"},
                                     {{"--image", "a.exr", "--pixels", "100"}, "--pixels"},
                                     {{"--image", "a.exr", "--pixels", "100,1.5"}, "--pixels"},
                                     {{"--image", "a.exr", "--pixels", "1e9,1"}, "--pixels"},
                                     {{"--image", "a.exr", "--pixels", "20000,20000"}, "--pixels"},
                                     {{"--image", "a.exr", "--sensor-mm", "36"}, "--sensor-mm"},
                                     {{"--image", "a.exr", "--sensor-mm", "36,24"}, "squares"}}) {
        std::vector<std::string> arguments{"ghosts", "singlet.toml"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        expect_refused(place, arguments, {word});
    }
    expect_refused(place, {"ghosts", "nonesuch"}, {"nonesuch"});
}

}  // namespace lensproof::ghosts_command_test
