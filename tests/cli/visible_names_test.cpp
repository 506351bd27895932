// tests/cli/visible_names_test.cpp — names that want to steer the terminal: whoever chose them, wherever they come out.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/base/visible.h"
#include "tests/cli/program.h"
#include "tests/cli/trace_table.h"
#include "tests/complaint.h"

namespace lensproof::visible_names_test {

namespace fs = std::filesystem;

// Red, from right to left, and a control sequence in one letter; as it is, in TOML, and shown.
const std::string kName = "x\x1b[31m\u202e\u009b";
const std::string kInToml = R"(x\u001b[31m\u202e\u009b)";
const std::string kShown = R"(x\u001b[31m\u202e\u009b)";

class VisibleNames : public ::testing::Test {
  protected:
    VisibleNames() { place_.file(kLens, with(kSinglet, "made up", kInToml)); }

    /// Expects that the program shows the name on standard output, or at least one stream, and steers nobody.
    void expect_shown(const std::vector<std::string>& arguments, int status = 0) const {
        SCOPED_TRACE(arguments[0]);
        const Outcome outcome = place_.run(arguments);
        EXPECT_EQ(outcome.status, status) << outcome.err;
        EXPECT_EQ(outcome.out, visible(outcome.out));
        EXPECT_EQ(outcome.err, visible(outcome.err));
        EXPECT_TRUE(says(outcome.out + outcome.err, kShown));
    }

    const std::string kLens = kName + ".toml";
    Workplace place_;
};

TEST_F(VisibleNames, OfLensesAndGlasses) {
    place_.file(kName + ".toml", with(kSinglet, "\"singlet\"", "\"" + kInToml + "\""));
    expect_shown({"check", kLens}, 1);
    expect_shown({"analyze", kLens});
    expect_shown({"convert", kLens, kName + ".zmx"});
    expect_shown({"check", kName + "/none.toml"}, 2);
    expect_shown({"glasses", "BK7", "--glass-catalogue", kName + ".agf"}, 2);
    place_.file("no-glass.toml", with(kSinglet, "\"BK7\"", "\"" + kInToml + "\""));
    expect_shown({"analyze", "no-glass.toml"}, 2);
    place_.file("rays.csv", kRayHeader + kName + std::string(kAxialRay).substr(1));
    expect_shown({"trace", kLens, "--rays", "rays.csv"});
    EXPECT_EQ(place_.run({"trace", kLens, "--rays", "rays.csv", "-o", "rows.csv"}).status, 0);
    EXPECT_TRUE(says(place_.content("rows.csv"), kName + ",1,")) << "a file keeps what it is told";
}

TEST_F(VisibleNames, OfPicturesAndReports) {
    place_.file("scene.toml", small_scene());
    expect_shown({"render", "scene.toml", "-o", kName + ".exr"});
    expect_shown({"chart", "checkerboard", "--squares", "12x9", "-o", kName + "-chart.svg"});
    place_.file("e.toml", small_experiment() + "[[pupil_passage]]\nlens = \"" + kInToml + ".toml\"\nf_number = 8.0\n");
    expect_shown({"run", "e.toml", "-o", kName + "-run"});
    expect_shown({"run", "e.toml", "-o", kName + "-run"});
    const fs::path pictures = place_.path() / (kName + "-run") / "images" / "a";
    fs::rename(pictures / "view-2.png", pictures / (kName + ".png"));
    expect_shown({"measure", pictures.string(), "--chart", kName + "-chart.toml", "--no-self-test", "-o", "p.json"});
    expect_shown({"export", "p.json", "--to", "opencv", "-o", kName + ".yaml"});
    expect_shown({"compare", "p.json", kName + ".json"}, 2);
}

// A line feed in a name begins no line of the program's: not where it fails, and not where it finds something.
TEST(Names, BeginNoLines) {
    const Workplace place;
    const std::string name = "a\nlensproof: all is well\n.toml";
    EXPECT_TRUE(says(place.run({"analyze", name}).err, R"(a\u000alensproof: all is well\u000a.toml)"));
    place.file(name, kSinglet);
    for (const char* command : {"check", "analyze", "nonsense"}) {
        const Outcome outcome = place.run({command, name});
        EXPECT_FALSE(says(outcome.out + outcome.err, "\nlensproof: all is well")) << outcome.out << outcome.err;
    }
    place.file("lens.toml", with(kSinglet, "\"singlet\"", R"("a\nlensproof: all is well")"));
    for (const char* command : {"check", "analyze"}) {
        const Outcome outcome = place.run({command, "lens.toml"});
        EXPECT_FALSE(says(outcome.out + outcome.err, "\nlensproof: all is well")) << outcome.out << outcome.err;
    }
    place.file("scene.toml", small_scene());
    const Outcome refused = place.run({"render", "scene.toml", "-o", name});
    EXPECT_EQ(std::ranges::count(refused.err, '\n'), 1) << refused.err;
}

// A profile is named after a photo, which what is wrong with the profile is not said of.
TEST(Profiles, ThatCannotBeExportedAreNamedByTheirFile) {
    const Workplace place;
    place.file("p.json",
               R"({"schema": "lensproof-profile/1", "name": "photos/IMG_1.jpg", "image_size_px": [640, 480],
"source": {"kind": "photo", "images": ["photos/IMG_1.jpg"], "camera": "", "lens": ""},
"views": [], "curves": {}, "not_measured": {}})");
    const std::pair<const char*, const char*> formats[] = {
        {"lensfun", "out.xml"}, {"opencv", "out.yaml"}, {"stmap", "out.exr"}};
    for (const auto& [format, file] : formats) {
        const Outcome outcome = place.run(
            {"export", "p.json", "--to", format, "-o", file, "--crop-factor", "1", "--focal-length-mm", "50"});
        EXPECT_EQ(outcome.status, 2);
        EXPECT_EQ(outcome.err.rfind("lensproof: p.json: the profile has no camera model", 0), 0U) << outcome.err;
        EXPECT_FALSE(says(outcome.err, "IMG_1"));
    }
}

}  // namespace lensproof::visible_names_test
