// tests/experiments/studies/tradeoff/tradeoff_study_test.cpp — [[tradeoff]]: a scene through several lenses, and what
// a file may not say.
#include "experiments/studies/tradeoff/tradeoff_study.h"

#include <gtest/gtest.h>

#include "engine/base/write_file.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::studies::tradeoff_study_test {

constexpr const char* kScene = R"([camera]
lens = "tessar"
f_number = 8.0
focus_distance_mm = 2000.0
sensor_mm = [60.0, 40.0]
pixels = [300, 200]
shutter_s = 0.01
iso = 100.0
response = "cie-1931"
[render]
layers = 4
strata_per_layer = 1
[light]
illuminant = "D65"
luminance_cd_m2 = 1000.0
[chart]
kind = "checkerboard"
squares = [12, 8]
square_mm = 120.0
[pose]
distance_mm = 2000.0
)";

class TradeoffStudy : public testing::Test {
  protected:
    TradeoffStudy() { write_file(folder_.path() / "scene.toml", kScene); }

    std::vector<findings::Study> read(const std::string& table) {
        const std::filesystem::path file = folder_.path() / "tradeoff.toml";
        write_file(file, "title = \"t\"\n[[tradeoff]]\nname = \"chart\"\nscene = \"scene.toml\"\n" + table);
        findings::ExperimentFile experiment{.top = TomlTable::read(file)};
        return read_tradeoff(experiment);
    }

  private:
    TestFolder folder_;
};

TEST_F(TradeoffStudy, SaysWhatSufficesForEachCase) {
    const std::vector<findings::Study> studies = read(R"(title = "A chart"
rungs = ["thin-lens"]
pixels = 64
samples_per_pixel = 1
seeds = 2
tolerance = "1000px,100ev,1000de"
cases = [{ name = "as-it-is" }, { name = "petzval", scene.camera = { lens = "petzval", f_number = 4.0 } }]
)");
    const findings::Findings found = studies.at(0).carry_out({}, [](const std::string&, double) {}, {});
    ASSERT_EQ(found.tables.size(), 2U);
    const Json& scenes = found.tables[0].second;
    ASSERT_EQ(scenes.size(), 2U);
    EXPECT_EQ(scenes[0]["name"], "chart-as-it-is");
    EXPECT_EQ(scenes[1]["name"], "chart-petzval");
    const Json& suffices = found.tables[1].second;
    ASSERT_EQ(suffices.size(), 2U);
    EXPECT_EQ(suffices[1]["picture"], "A chart");
    EXPECT_EQ(suffices[1]["lens"], "petzval");
    EXPECT_EQ(suffices[1]["sure"], Json(true));
    // One of the picture, one a scene, and the two models, which all curves of theirs are coloured by.
    ASSERT_EQ(found.subjects.size(), 5U);
    EXPECT_EQ(found.subjects[0].facts.size(), 2U);
    EXPECT_EQ(found.subjects[3].id, "thin-lens");
    EXPECT_EQ(found.subjects[3].facts.size(), 2U);
}

TEST_F(TradeoffStudy, RefusesWhatItCannotRead) {
    const auto complaint = [&](const std::string& table) { return complaint_about([&] { read(table); }); };
    EXPECT_TRUE(says(complaint("tolerance = \"1\"\n"), "tolerance"));
    EXPECT_TRUE(says(complaint("rungs = [\"thick-lens\"]\n"), "thick-lens"));
    EXPECT_TRUE(says(complaint("cases = [{ name = \"a\" }, { name = \"a\" }]\n"), "chart-a"));
    EXPECT_TRUE(says(complaint("cases = [{ name = \"a\", scene.camera.f_numbers = 1 }]\n"), "f_numbers"));
}

}  // namespace lensproof::studies::tradeoff_study_test
