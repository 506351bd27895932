// tests/experiments/studies/stray_light/stray_study_test.cpp — a scene's variants as an experiment states them, what is
// found of them, and what is said of it.
#include "experiments/studies/stray_light/stray_study.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "engine/base/write_file.h"
#include "tests/complaint.h"
#include "tests/test_folder.h"

namespace lensproof::studies::stray_study_test {

/// A lens of few ghosts.
constexpr const char* kLens = R"(name = "Achromat"
design = "doublet"
source = "made for this test"
projection = "rectilinear"
surfaces = [
  { stop = true,          thickness_mm = 1.0,                   semi_diameter_mm = 12.5 },
  { radius_mm =   61.47,  thickness_mm = 6.0, glass = "N-BK7",  semi_diameter_mm = 14.0 },
  { radius_mm =  -44.64,  thickness_mm = 2.5, glass = "N-SF5",  semi_diameter_mm = 14.0 },
  { radius_mm = -129.94,  thickness_mm = 95.9,                  semi_diameter_mm = 14.0 },
]
)";

/// A lamp beside its axis on few pixels, before a wall.
constexpr const char* kScene = R"(f_number = 4.0
focus_distance_mm = 2000.0
position_mm = [0.0, 0.0, 0.0]
look_at_mm = [0.0, 0.0, 2000.0]
sensor_mm = [36.0, 24.0]
pixels = [24, 16]
shutter_s = 0.01
iso = 100.0
response = "cie-1931"

[render]
samples_per_pixel = 32
layers = 4
strata_per_layer = 1
max_bounces = 1

[[materials]]
name = "wall"
kind = "diffuse"
reflectance = 0.2

[[objects]]
name = "wall"
shape = "quad"
size_mm = [4000.0, 4000.0]
rotate_deg = [180.0, 0.0, 0.0]
translate_mm = [0.0, 0.0, 2500.0]
material = "wall"

[[lights]]
kind = "sphere"
position_mm = [150.0, 0.0, 1500.0]
radius_mm = 20.0
luminance_cd_m2 = 1e5
illuminant = "D65"
)";

constexpr const char* kTable = R"([[stray_light]]
name = "lamp"
scene = "scene.toml"
passes = ["imaged", "direct", "ghosts"]
brightening_ev = { ghosts = 6.0 }
samples_per_pixel = { ghosts = 48 }
ghosts_deg = 5.0
variants = [
    { name = "bare" },
    { name = "one", scene.camera.coating = "4=broadband" },
    { name = "half", label = "half of the light", scene.camera.shutter_s = 0.005 },
]
)";

class StrayStudy : public testing::Test {
  protected:
    void SetUp() override {
        const std::filesystem::path lens = folder_.path() / "lens.toml";
        write_file(lens, kLens);
        write_file(folder_.path() / "scene.toml", fmt::format("[camera]\nlens = \"{}\"\n{}", lens.string(), kScene));
    }

    findings::ExperimentFile file(const std::string& text) {
        return {.top = TomlTable::parse(text, folder_.path() / "experiment.toml")};
    }
    StrayScene scene(const std::string& more = "") {
        findings::ExperimentFile experiment = file(kTable + more);
        return read_stray_scene(experiment.top.tables("stray_light").at(0), experiment);
    }
    std::string complaint(const std::string& text) {
        return complaint_about([&] {
            findings::ExperimentFile experiment = file(text);
            read_stray_light(experiment);
        });
    }

    TestFolder folder_;
};

const findings::RunProgress kSilent = [](const std::string& /*step*/, double /*done*/) {};

TEST_F(StrayStudy, ReadsVariantsOverItsScene) {
    const StrayScene read = scene();
    ASSERT_EQ(read.variants.size(), 3U);
    EXPECT_TRUE(read.variants[0].setup.camera.coatings.empty());
    EXPECT_EQ(read.variants[1].setup.camera.coatings, std::vector<std::string>{"4=broadband"});
    EXPECT_EQ(read.variants[1].setup.camera.f_number, 4.0);
    EXPECT_EQ(read.variants[2].label, "half of the light");
    EXPECT_EQ(read.columns, 3);
    EXPECT_TRUE(read.stray_filter.is_box());
    EXPECT_TRUE(says(complaint("[[stray_light]]\nname = \"a\"\nscene = \"scene.toml\"\nvariants = [\n"
                               "{ name = \"b\", scene.camera.f_numbre = 3.0 }]\n"),
                     "experiment.toml:5: "));
    EXPECT_TRUE(says(complaint("[[stray_light]]\nname = \"a\"\nscene = \"no.toml\"\nvariants = []\n"), "no.toml"));
    EXPECT_TRUE(says(complaint("[[stray_light]]\nname = \"a\"\nscene = \"scene.toml\"\nvariants = []\n"),
                     "variants: has 0 tables, expected 1 to 100"));
    const std::string filtered =
        "[[stray_light]]\nname = \"a\"\nscene = \"scene.toml\"\nvariants = [{ name = \"b\" }]\n";
    findings::ExperimentFile experiment = file(filtered + "stray_filter = \"gaussian\"\n");
    EXPECT_EQ(read_stray_scene(experiment.top.tables("stray_light").at(0), experiment).stray_filter.name(), "gaussian");
    EXPECT_TRUE(says(complaint(filtered + "stray_filter = \"fir\"\n"), "expected one of: box, tent, gaussian"));
    const std::string table = kTable;
    EXPECT_TRUE(says(complaint(table + "[[stray_light.checks]]\nlight = \"barrel\"\nof = \"one\"\nat_most = 1\n"),
                     "light: is \"barrel\", expected one of: imaged, direct, ghosts, picture"));
    EXPECT_TRUE(says(complaint(table + "[[stray_light.checks]]\nlight = \"ghosts\"\nof = \"one\"\nat_most = 1\n"),
                     "is set against itself"));
    EXPECT_TRUE(says(complaint(table + "[[stray_light.checks]]\nlight = \"ghosts\"\nof = \"one\"\nover = \"bare\"\n"),
                     "expected one of at_most, at_least and between"));
    EXPECT_TRUE(says(complaint(table + "[[stray_light]]\nname = \"lamp\"\nscene = \"scene.toml\"\n"), "lamp"));
}

// Half of the exposure is half of the light, in each pass. A coating on one surface takes its ghosts and no other's:
// what others gain passes it twice or four times more, each time by less than Fresnel's 5 % of dense glass.
TEST_F(StrayStudy, FindsWhatTheVariantsChange) {
    const StrayScene read = scene(
        "[[stray_light.checks]]\nlight = \"ghosts\"\nof = \"half\"\nover = \"bare\"\nbetween = [0.4, 0.6]\n"
        "[[stray_light.checks]]\nghosts_of_surface = 4\nof = \"one\"\nover = \"bare\"\nat_most = 0.2\n"
        "[[stray_light.checks]]\nghosts_beside_surface = 4\nof = \"one\"\nover = \"bare\"\nbetween = [1.0, 1.25]\n"
        "[[stray_light.checks]]\nlight = \"ghosts\"\nover_light = \"direct\"\nof = \"bare\"\nat_least = 1000\n");
    std::vector<VariantFindings> variants;
    for (const StrayVariant& variant : read.variants) {
        variants.push_back(render_variant(read, variant, {}, kSilent));
    }
    for (const char* pass : {"imaged", "direct", "ghosts"}) {
        const Estimate whole = variants[0].light(pass);
        const Estimate half = variants[2].light(pass);
        EXPECT_GT(whole.value, 0.0) << pass;
        EXPECT_NEAR(half.value / whole.value, 0.5, 1e-9) << pass;  // the same samples
    }
    const double sum =
        variants[0].light("imaged").value + variants[0].light("direct").value + variants[0].light("ghosts").value;
    EXPECT_NEAR(variants[0].light(kPicture).value, sum, 1e-12 * sum);
    const formats::Image picture = picture_of(variants[0].passes);
    double mean = 0.0;
    for (const float value : picture.pixels) {
        mean += value / static_cast<double>(picture.pixels.size());
    }
    EXPECT_NEAR(mean, sum, 1e-5 * sum);

    const findings::Findings found = stray_findings(read, variants, findings::Quality::full);
    ASSERT_EQ(found.checks.size(), 4U);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(found.checks[i].verdict(), findings::Verdict::pass)
            << found.checks[i].label << " " << found.checks[i].value << " ± " << found.checks[i].sigma;
    }
    EXPECT_EQ(found.checks[3].verdict(), findings::Verdict::fail);
    ASSERT_EQ(found.subjects.size(), 4U);
    EXPECT_EQ(found.subjects[0].pictures.size(), 5U);  // four sheets and the ghosts' chart
    EXPECT_TRUE(says(found.subjects[0].pictures.back().bytes, "Ghosts of two reflections"));
    EXPECT_EQ(found.subjects[1].pictures.size(), 4U);
    EXPECT_EQ(found.tables.at(0).second[0]["variants"].size(), 3U);
}

// What a lamp sends straight to the film is the same from either end of its paths, within four standard errors.
TEST_F(StrayStudy, LampsAreSeenFromEitherEndOfTheirPaths) {
    const auto direct = [&](const std::string& paths) {
        findings::ExperimentFile experiment = file(
            "[[stray_light]]\nname = \"lamp\"\nscene = \"scene.toml\"\npasses = [\"imaged\", \"direct\"]\npaths = " +
            paths + "\nvariants = [{ name = \"only\" }]\n");
        const StrayScene read = read_stray_scene(experiment.top.tables("stray_light").at(0), experiment);
        return render_variant(read, read.variants[0], {}, kSilent);
    };
    const VariantFindings camera = direct("\"camera\"");
    const VariantFindings light = direct("{ direct = \"light\" }");
    EXPECT_EQ(camera.light("imaged").value, light.light("imaged").value);
    EXPECT_NE(camera.light("direct").value, light.light("direct").value);
    const Estimate ours = camera.light("direct");
    const Estimate theirs = light.light("direct");
    EXPECT_NEAR(ours.value, theirs.value, 4.0 * std::hypot(ours.standard_error, theirs.standard_error));
    EXPECT_LT(theirs.standard_error, 0.1 * theirs.value);
    EXPECT_TRUE(camera.noise().has_value());
    EXPECT_TRUE(says(complaint("[[stray_light]]\nname = \"a\"\nscene = \"scene.toml\"\npaths = \"both ways\"\n"),
                     "paths: is \"both ways\", expected one of: camera, light, both"));
    EXPECT_TRUE(
        says(complaint("[[stray_light]]\nname = \"a\"\nscene = \"scene.toml\"\npaths = { ghosts = \"light\" }\n"),
             "ghosts: is not a key that is known here"));
}

// One table stands for many variants, whose pictures stand side by side whatever their sizes, and whose light is drawn
// over what is varied: twice the time is twice the light, with the same samples.
TEST_F(StrayStudy, VariesTheScene) {
    findings::ExperimentFile experiment = file(
        "[[stray_light]]\nname = \"lamp\"\nscene = \"scene.toml\"\npasses = [\"imaged\", \"direct\"]\ncolumns = 2\n"
        "[[stray_light.variants]]\nname = \"at\"\n"
        "vary.scene.camera.shutter_s = [0.01, 0.02]\nvary.scene.camera.coating = [\"none\", \"broadband\"]\n"
        "[[stray_light.variants]]\nname = \"larger\"\nscene.camera.pixels = [48, 32]\n");
    const StrayScene read = read_stray_scene(experiment.top.tables("stray_light").at(0), experiment);
    ASSERT_EQ(read.variants.size(), 5U);
    EXPECT_EQ(read.variants[3].name, "at-broadband-0_02");
    EXPECT_EQ(read.variants[3].label, "broadband, shutter_s 0.02");
    EXPECT_EQ(read.variants[3].setup.camera.coatings, std::vector<std::string>{"broadband"});
    std::vector<VariantFindings> variants;
    for (const StrayVariant& variant : read.variants) {
        variants.push_back(render_variant(read, variant, {}, kSilent));
    }
    for (const char* pass : {"imaged", "direct"}) {
        EXPECT_NEAR(variants[1].light(pass).value, 2.0 * variants[0].light(pass).value,
                    1e-9 * variants[1].light(pass).value);
    }
    const findings::Findings found = stray_findings(read, variants, findings::Quality::full);
    const std::vector<findings::Picture>& pictures = found.subjects.at(0).pictures;
    ASSERT_EQ(pictures.size(), 4U);  // three sheets and the chart
    EXPECT_EQ(pictures[0].width, 2 * 48 + 4);
    EXPECT_EQ(pictures[0].height, 3 * 32 + 2 * 4);
    EXPECT_EQ(pictures[3].name, "lamp/light.svg");
    EXPECT_TRUE(says(pictures[3].bytes, "shutter_s"));
    EXPECT_TRUE(says(pictures[3].bytes, "broadband"));
    EXPECT_EQ(found.tables.at(0).second[0]["variants"][1]["at"]["scene.camera.shutter_s"].number(), 0.02);
}

// Each sample makes the picture better: its error falls as a power, with the root of their number or nearly so.
TEST_F(StrayStudy, PicturesGrow) {
    findings::ExperimentFile experiment = file(
        "[[stray_light]]\nname = \"lamp\"\nscene = \"scene.toml\"\npasses = [\"imaged\"]\ngrowth_samples = 64\n"
        "variants = [{ name = \"only\", scene.camera.pixels = [96, 64] }]\n");
    const StrayScene read = read_stray_scene(experiment.top.tables("stray_light").at(0), experiment);
    const VariantFindings found = render_variant(read, read.variants[0], {}, kSilent);
    ASSERT_EQ(found.growth.size(), 6U);
    EXPECT_EQ(found.growth.back().samples, 32);
    EXPECT_EQ(found.growth[0].pass_errors.size(), 1U);
    const PowerLaw law = growth_law(found.growth);
    EXPECT_LT(law.exponent, -0.3);
    EXPECT_GT(law.exponent, -1.0);
}

}  // namespace lensproof::studies::stray_study_test
