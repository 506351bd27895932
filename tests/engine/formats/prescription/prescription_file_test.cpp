// What is wrong with a prescription is said with file, line and key.
#include "engine/formats/prescription/prescription_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "engine/base/toml.h"
#include "engine/base/write_file.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/lens.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::formats::prescription_file_test {

class PrescriptionFile : public testing::Test {
  protected:
    std::filesystem::path write(const std::string& name, const std::string& content) {
        std::filesystem::path file = folder_.path() / name;
        write_file(file, content);
        return file;
    }

    /// The complaint about a lens file, or "" when there is none.
    static std::string complaint(const std::filesystem::path& file) {
        return complaint_about([&] { load_lens(file.string()); });
    }

    TestFolder folder_;
};

constexpr const char* kHead = "name = \"x\"\nsource = \"y\"\n";
constexpr const char* kStop = "[[surfaces]]\nstop = true\nthickness_mm = 1\nsemi_diameter_mm = 2\n";

TEST_F(PrescriptionFile, NegativeSemiDiameterIsNamedWithItsLine) {
    const auto file =
        write("negative.toml",
              std::string(kHead) + kStop + "[[surfaces]]\nradius_mm = 10\nthickness_mm = 1\nsemi_diameter_mm = -15\n");
    const std::string said = complaint(file);
    EXPECT_TRUE(says(said, "negative.toml:7: surfaces[2].semi_diameter_mm is -15"));
    EXPECT_TRUE(says(said, "expected"));
}

TEST_F(PrescriptionFile, UnknownGlassIsNamedWithItsLine) {
    const auto file =
        write("glass.toml", std::string(kHead) + kStop +
                                "[[surfaces]]\nthickness_mm = 1\nglass = \"NOSUCH\"\nsemi_diameter_mm = 1\n");
    const std::string said = complaint(file);
    EXPECT_TRUE(says(said, "glass.toml:7: surfaces[2].glass is \"NOSUCH\""));
    EXPECT_TRUE(says(said, "lensproof glasses")) << "where the glasses are listed: " << said;
}

// What a wall does not state is as for all of them; without a table all is black.
TEST_F(PrescriptionFile, BarrelsStateWhatTheirWallsScatter) {
    const std::string lens = std::string(kHead) + kStop;
    const auto barrel = [&](const std::string& text) {
        return load_lens(write("b.toml", lens + text).string()).barrel;
    };
    EXPECT_TRUE(barrel("").is_black());
    const optics::BarrelFinish found =
        barrel("[barrel]\nalbedo = 0.05\ngloss = 0.4\nedges = { albedo = 0.2, roughness = 1.0 }\n");
    EXPECT_EQ(found.tube, (optics::WallFinish{.albedo = 0.05, .gloss = 0.4}));
    EXPECT_EQ(found.blades, found.tube);
    EXPECT_EQ(found.edges, (optics::WallFinish{.albedo = 0.2, .gloss = 0.4, .roughness = 1.0}));
    const auto said = [&](const std::string& text) { return complaint(write("b.toml", lens + text)); };
    EXPECT_TRUE(says(said("[barrel]\nalbedo = 1.5\n"), "b.toml:8: barrel.albedo"));
    EXPECT_TRUE(says(said("[barrel]\nalbedo = nan\n"), "barrel.albedo"));
    EXPECT_TRUE(says(said("[barrel]\nedges = { gloss = -0.1 }\n"), "barrel.edges.gloss"));
    EXPECT_TRUE(says(said("[barrel]\nroughnes = 0.1\n"), "barrel.roughnes"));
    EXPECT_TRUE(says(said("[barrel]\nblades = 0.1\n"), "barrel.blades"));
}

TEST_F(PrescriptionFile, EveryOtherDefectIsAnInputError) {
    const std::string row = "[[surfaces]]\nthickness_mm = 1\nsemi_diameter_mm = 1\n";
    for (const std::string& text :
         {std::string(""), std::string("name = "), std::string(kHead), std::string(kHead) + row,
          std::string(kHead) + kStop + kStop, std::string(kHead) + kStop + row + "radius_mm = nan\n",
          std::string(kHead) + kStop + row + "radius_mm = 1e-9\n",
          std::string(kHead) + kStop + row + "semi_diamter_mm = 3\n", std::string(kHead) + kStop + row + "glass = 3\n",
          std::string(kHead) + "surfaces = 3\n",
          std::string(kHead) + kStop + "[[surfaces]]\nn_d = 1.5\nthickness_mm = -1\nsemi_diameter_mm = 1\n" + row,
          std::string(kHead) + kStop + "[[surfaces]]\nthickness_mm = \"1\"\nsemi_diameter_mm = 1\n",
          std::string(kHead) + "projection = \"square\"\n" + kStop,
          std::string(kHead) + kStop + row + "mirror = true\nglass = \"BK7\"\n"}) {
        const std::string said = complaint(write("defect.toml", text));
        EXPECT_TRUE(says(said, "defect.toml")) << text;
    }
    EXPECT_TRUE(says(complaint("no-such-lens"), "tessar"));
    EXPECT_NE(complaint(folder_.path()), "");
}

TEST_F(PrescriptionFile, CsvCarriesTheSameLens) {
    const auto file = write("plate.csv",
                            "# a comment\nsurface,radius_mm,thickness_mm,n_d,V_d,semi_aperture_mm,kind\n"
                            "1,50,4,1.5168,64.17,10,glass\n2,inf,1,1.0,,10,air\n3,0,40,1,,5,stop\n");
    const optics::Lens lens = load_lens(file.string());
    ASSERT_EQ(lens.surfaces.size(), 3U);
    EXPECT_DOUBLE_EQ(lens.surfaces[0].curvature, 0.02);
    EXPECT_EQ(lens.surfaces[1].curvature, 0.0);
    EXPECT_TRUE(lens.surfaces[2].is_stop);
    EXPECT_DOUBLE_EQ(lens.image_z, 45.0);
    EXPECT_NEAR(optics::refractive_index(lens.surfaces[0].medium.formula, 587.5618), 1.5168, 1e-12);

    const std::string said = complaint(write("bad.csv",
                                             "surface,radius_mm,thickness_mm,n_d,V_d,semi_aperture_mm,kind\n"
                                             "1,5O,4,1.5,60,10,glass\n"));
    EXPECT_TRUE(says(said, "bad.csv:2: radius_mm is \"5O\""));
}

/// A file's own folder comes first, then the working folder, as on the command line.
TEST(LensName, IsRelativeToTheFileThatStatesIt) {
    const TestFolder folder;
    const auto named = [&](const std::string& lens) {
        TomlTable table = TomlTable::parse("lens = \"" + lens + "\"", (folder.path() / "case.toml").string());
        return read_lens_name(table);
    };
    EXPECT_EQ(named("tessar"), "tessar");
    EXPECT_EQ(named("lens.toml"), "lens.toml") << "none lies beside it";
    write_file(folder.path() / "lens.toml", "name = \"mine\"\n");
    EXPECT_EQ(named("lens.toml"), (folder.path() / "lens.toml").string());
}

}  // namespace lensproof::formats::prescription_file_test
