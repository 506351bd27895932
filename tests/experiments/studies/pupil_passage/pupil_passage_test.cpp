// How many camera paths leave a lens, counted; and how the counts become checks, drawings and a report.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/base/file.h"
#include "engine/base/input_error.h"
#include "engine/optics/illumination.h"
#include "engine/pupil/rear_disc.h"
#include "experiments/studies/pupil_passage/passage_report.h"
#include "tests/test_folder.h"

namespace lensproof::studies {

namespace {

runner::PassageSetting fisheye() {
    return {.lens = "muller-fisheye",
            .f_number = 8.0,
            .published = runner::PassageSetting::Published{.whole_element_percent = 10.0, .pupil_percent = 82.0}};
}

// On the axis the paths that pass fill a disc: that of the cone whose projected solid angle is known by quadrature. In
// the innermost ring, 1/8 of the circle wide, that share changes by the vignetting there, 8 %.
TEST(PupilPassage, OfTheWholeElementIsTheShareOfItsDisc) {
    const Passage passage = measure_passage(fisheye(), 0);
    const optics::TraceLens<double> lens = optics::at_wavelength<double>(passage.lens, 550.0);
    const pupil::RearDisc disc = pupil::rear_disc(lens, passage.circle_mm);
    const double sine2 = optics::image_bundle(lens, 0.0).projected_solid_angle / std::numbers::pi;
    const double radius = (lens.image_z - disc.plane_z) * std::sqrt(sine2 / (1.0 - sine2));
    const double share = radius * radius / (disc.radius * disc.radius);
    EXPECT_NEAR(passage.whole_element.rings[0] / share, 1.0, 0.08);
    EXPECT_GT(passage.pupil.mean, 0.97);
    EXPECT_LT(passage.whole_element.mean, 0.25);
    // What is drawn from each of four heights: some blocked, some not; of the pupil's all but the outermost pass.
    ASSERT_EQ(passage.whole_element.drawn.size(), 60U);
    ASSERT_EQ(passage.pupil.drawn.size(), 60U);
    const auto passing = [](const std::vector<DrawnPath>& paths) {
        return std::ranges::count_if(paths, [](const DrawnPath& path) { return path.passes; });
    };
    EXPECT_GT(passing(passage.whole_element.drawn), 4);
    EXPECT_LT(passing(passage.whole_element.drawn), 40);
    EXPECT_GE(passing(passage.pupil.drawn), 58);
}

TEST(PupilPassage, IsReported) {
    runner::Experiment experiment;
    experiment.title = "passage";
    experiment.file = "passage.toml";
    const std::vector<Passage> passages{measure_passage(fisheye(), 0)};
    const std::vector<runner::Check> checks = passage_checks(passages);
    ASSERT_EQ(checks.size(), 3U);
    EXPECT_EQ(runner::overall(checks), runner::Verdict::pass);
    EXPECT_NEAR(checks[0].value, 100.0 * (1.0 - passages[0].pupil.mean), 1e-12);
    EXPECT_EQ(checks[2].limit, 18.0);
    const TestFolder folder;
    experiment.file = folder.path() / "passage.toml";
    write_file(experiment.file, "title = \"passage\"\n");
    const auto report = passage_report_json(experiment, passages, {});
    EXPECT_EQ(report["verdict"], "PASS");
    EXPECT_EQ(report["passages"][0]["pupil_rings_percent"].size(), 8U);
    EXPECT_EQ(report["passages"][0]["published_percent"]["pupil"], 82.0);
    const auto drawings = passage_drawings(passages);
    const std::string name = report["subjects"][0]["pictures"][0]["name"].text();
    ASSERT_TRUE(drawings.contains(name));
    EXPECT_NE(drawings.at(name).find("Points of the pupil of each pixel"), std::string::npos);
    EXPECT_NE(drawings.at(name).find("ray blocked"), std::string::npos);
}

TEST(PupilPassage, ReadsItsExperiment) {
    const TestFolder folder;
    const auto file = folder.path() / "e.toml";
    write_file(file, "title = \"t\"\n[[pupil_passage]]\nlens = \"tessar\"\nf_number = 4.0\n");
    const runner::Experiment experiment = runner::read_experiment(file);
    ASSERT_EQ(experiment.pupil_passage.size(), 1U);
    EXPECT_FALSE(experiment.pupil_passage[0].published);
    write_file(file,
               "title = \"t\"\n[[pupil_passage]]\nlens = \"tessar\"\nf_number = 4.0\n"
               "published_percent = { pupil = 120.0, whole_element = 1.0 }\n");
    EXPECT_THROW(runner::read_experiment(file), InputError);
    write_file(file, "title = \"t\"\n[[pupil_passage]]\nlens = \"tessar\"\nf_stop = 4.0\n");
    EXPECT_THROW(runner::read_experiment(file), InputError);
}

}  // namespace

}  // namespace lensproof::studies
