// How many camera paths leave a lens, counted; and how the counts become checks, drawings and a report.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/base/input_error.h"
#include "engine/optics/illumination.h"
#include "engine/pupil/rear_disc.h"
#include "experiments/studies/pupil_passage/passage_study.h"
#include "tests/complaint.h"

namespace lensproof::studies::pupil_passage_test {

PassageSetting fisheye() {
    return {.lens = "muller-fisheye",
            .f_number = 8.0,
            .published = PassageSetting::Published{.whole_element_percent = 10.0, .pupil_percent = 82.0}};
}

// On the axis the paths that pass fill a disc: that of the cone whose projected solid angle is known by quadrature. In
// the innermost ring, 1/8 of the circle wide, that fraction changes by the vignetting there, 8 %.
TEST(PupilPassage, OfTheWholeElementIsTheShareOfItsDisc) {
    const Passage passage = measure_passage(fisheye(), 0);
    const optics::TraceLens<double> lens = optics::at_wavelength<double>(passage.lens, 550.0);
    const pupil::RearDisc disc = pupil::rear_disc(lens, passage.circle_mm);
    const double sine2 = optics::image_bundle(lens, 0.0).projected_solid_angle / std::numbers::pi;
    const double radius = (lens.image_z - disc.plane_z) * std::sqrt(sine2 / (1.0 - sine2));
    const double fraction = radius * radius / (disc.radius * disc.radius);
    EXPECT_NEAR(passage.whole_element.rings[0] / fraction, 1.0, 0.08);
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
    const std::vector<Passage> passages{measure_passage(fisheye(), 0)};
    const findings::Findings found = passage_findings(passages);
    ASSERT_EQ(found.checks.size(), 3U);
    EXPECT_EQ(findings::overall(found.checks), findings::Verdict::pass);
    EXPECT_NEAR(found.checks[0].value, 100.0 * (1.0 - passages[0].pupil.mean), 1e-12);
    EXPECT_EQ(found.checks[2].limit, 18.0);
    const auto& [key, table] = found.tables.at(0);
    EXPECT_EQ(key, "passages");
    EXPECT_EQ(table[0]["pupil_rings_percent"].size(), 8U);
    EXPECT_EQ(table[0]["published_percent"]["pupil"], 82.0);
    const std::string& drawing = found.subjects.at(0).pictures.at(0).bytes;
    EXPECT_TRUE(says(drawing, "Points of the pupil of each pixel"));
    EXPECT_TRUE(says(drawing, "ray blocked"));
}

TEST(PupilPassage, ReadsItsExperiment) {
    const auto read = [](const std::string& rest) {
        TomlTable table = TomlTable::parse("lens = \"tessar\"\n" + rest, "e.toml");
        return read_passage_setting(table);
    };
    EXPECT_FALSE(read("f_number = 4.0\n").published);
    EXPECT_THROW(read("f_number = 4.0\npublished_percent = { pupil = 120.0, whole_element = 1.0 }\n"), InputError);
    EXPECT_THROW(read("f_stop = 4.0\n"), InputError);
}

}  // namespace lensproof::studies::pupil_passage_test
