// tests/cli/raw_files_test.cpp — a scene with a sensor: raw and developed files beside the film's.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::raw_files_test {

std::string sensor_table(const std::string& pattern = "RGGB") {
    return "\n[sensor]\npattern = \"" + pattern +
           "\"\nfull_well_electrons = 30000\nread_noise_electrons = 4\nbits = 14\n";
}

TEST(RawFiles, StandBesideTheFilmThatStaysWithoutNoise) {
    const Workplace place;
    place.file("film.toml", small_scene());
    place.file("camera.toml", small_scene() + sensor_table());
    ASSERT_EQ(place.run({"render", "film.toml", "--quiet"}).status, 0);
    EXPECT_FALSE(place.has("film.raw.png"));
    const auto json = place.json({"render", "camera.toml", "--quiet"});
    EXPECT_EQ(json["raw"], "camera.raw.png");
    EXPECT_EQ(json["demosaiced"], "camera.demosaiced.png");
    EXPECT_EQ(place.content("camera.png"), place.content("film.png"));
    const std::string raw = place.content("camera.raw.png");
    // A PNG's header: width, height, 16 bits, grey.
    EXPECT_EQ(raw.substr(16, 10), std::string("\0\0\0\x08\0\0\0\x06\x10\0", 10));
    EXPECT_TRUE(says(raw, "lensproof:pattern"));
    EXPECT_TRUE(says(raw, "lensproof:blackLevel"));
    EXPECT_EQ(place.content("camera.demosaiced.png").substr(24, 2), "\x10\x02") << "16 bits, RGB";
}

TEST(RawFiles, AreTheSameBytesOnAnyNumberOfThreadsAndOthersBySeed) {
    const Workplace place;
    place.file("scene.toml", small_scene() + sensor_table());
    ASSERT_EQ(place.run({"render", "scene.toml", "--threads", "1", "-o", "a.exr"}).status, 0);
    ASSERT_EQ(place.run({"render", "scene.toml", "--threads", "3", "-o", "b.exr"}).status, 0);
    ASSERT_EQ(place.run({"render", "scene.toml", "--seed", "1", "-o", "c.exr"}).status, 0);
    EXPECT_EQ(place.content("a.raw.png"), place.content("b.raw.png"));
    EXPECT_EQ(place.content("a.demosaiced.png"), place.content("b.demosaiced.png"));
    EXPECT_NE(place.content("a.raw.png"), place.content("c.raw.png"));
}

// What the samples are wrong by is added to the sensor's noise, and said: 16 times the samples take it to a quarter or
// less. Said in words where one would see it.
TEST(RawFiles, AreSaidToHoldTheRendersNoiseToo) {
    const Workplace place;
    place.file("scene.toml", small_scene() + sensor_table());
    const Outcome coarse = place.run({"render", "scene.toml", "--spp", "64", "--json", "-"});
    const Outcome fine = place.run({"render", "scene.toml", "--spp", "1024", "--json", "-"});
    const auto ratio = [](const Outcome& outcome) {
        return nlohmann::json::parse(outcome.out)["film_noise_over_sensor_noise"].get<double>();
    };
    EXPECT_GT(ratio(coarse), 0.3);
    EXPECT_LT(ratio(fine), 0.4 * ratio(coarse));
    EXPECT_TRUE(says(coarse.err, "the render's own noise is"));
}

// A shard's light is a part's; the whole's raw comes with the whole.
TEST(RawFiles, ComeOfAMergedWholeAndNotOfItsParts) {
    const Workplace place;
    place.file("scene.toml", small_scene() + sensor_table());
    ASSERT_EQ(place.run({"render", "scene.toml", "--spp", "32", "--shard", "1/2", "-o", "1.exr"}).status, 0);
    ASSERT_EQ(place.run({"render", "scene.toml", "--spp", "32", "--shard", "2/2", "-o", "2.exr"}).status, 0);
    EXPECT_FALSE(place.has("1.raw.png"));
    ASSERT_EQ(place.run({"merge", "1.exr", "-o", "part.exr", "--partial"}).status, 0);
    EXPECT_FALSE(place.has("part.raw.png"));
    EXPECT_EQ(place.json({"merge", "1.exr", "2.exr", "-o", "whole.exr"})["raw"], "whole.raw.png");
    EXPECT_TRUE(place.has("whole.raw.png"));
    EXPECT_TRUE(place.has("whole.demosaiced.png"));
}

TEST(RawFiles, FollowFromAPixelsFill) {
    const Workplace place;
    place.file("full.toml", small_scene() + sensor_table());
    place.file("part.toml", small_scene() + sensor_table() + "fill_factor = 0.25\n");
    ASSERT_EQ(place.run({"render", "full.toml"}).status, 0);
    ASSERT_EQ(place.run({"render", "part.toml"}).status, 0);
    EXPECT_NE(place.content("full.png"), place.content("part.png")) << "the film itself is sharper";
    expect_refused(place, {"render", "full.toml", "--filter", "gaussian"},
                   {"--filter is \"gaussian\", but full.toml has a table [sensor]"});
}

TEST(RawFiles, AreRefusedWithFileLineAndKey) {
    const Workplace place;
    place.file("scene.toml", small_scene() + sensor_table("RGBG"));
    const std::string text = small_scene() + sensor_table("RGBG");
    const auto line =
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find("pattern =")), '\n');
    expect_refused(place, {"render", "scene.toml"}, {"scene.toml:" + std::to_string(line + 1) + ": sensor.pattern"});
    place.file("good.toml", small_scene() + sensor_table());
    place.file("good.raw.png/in_the_way", "");
    EXPECT_EQ(place.run({"render", "good.toml"}).status, 2);
    EXPECT_FALSE(place.has("good.exr")) << "said before long work";
}

}  // namespace lensproof::raw_files_test
