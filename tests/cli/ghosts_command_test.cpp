// tests/cli/ghosts_command_test.cpp — `lensproof ghosts` as a user meets it: its JSON, its table, its picture, what it
// refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

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
                                     {{"--plot", "nowhere/"}, "nowhere"}}) {
        std::vector<std::string> arguments{"ghosts", "singlet.toml"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        expect_refused(place, arguments, {word});
    }
    expect_refused(place, {"ghosts", "nonesuch"}, {"nonesuch"});
}

}  // namespace lensproof::ghosts_command_test
