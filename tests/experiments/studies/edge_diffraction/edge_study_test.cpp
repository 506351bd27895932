// tests/experiments/studies/edge_diffraction/edge_study_test.cpp — what is said of light by rays and by waves.
#include "experiments/studies/edge_diffraction/edge_study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/complaint.h"

namespace lensproof::studies::edge_study_test {

/// A profile that falls with the cube of the distance, as a straight edge's rings do on average.
EdgeProfile cubic(double scale) {
    EdgeProfile profile{
        .octaves = {}, .rings = {{5.0, scale}, {50.0, 1e-3 * scale}}, .energy = scale, .near_streaks = 0.7 * scale};
    for (const double from : kOctaves) {
        profile.octaves.push_back(scale * std::pow(from, -3.0));
    }
    return profile;
}

EdgeMap even_map() {
    return {.side = 8, .values = std::vector<float>(64, -3.0F)};
}

TEST(EdgeStudy, SaysHowFarRaysAreFromWaves) {
    EXPECT_NEAR(cubic(2.0).slope(), -3.0, 1e-12);
    const auto rays = [](double scale) {
        return EdgeRays{.profile = cubic(scale), .streaks = {{1.0, 0.05}, {0.9, -0.3}}};
    };
    // Two batches of ±1 %: their mean's standard error is 1 %.
    const EdgeDiffraction found{.rays = rays(1.02),
                                .batches = {rays(1.01), rays(1.03)},
                                .wave = cubic(1.0),
                                .ray_map = even_map(),
                                .wave_map = even_map()};
    const MeasuredEdges measured{{{.lens = "tessar", .f_number = 8.0, .blades = 7}, found}};
    const findings::Findings said = edge_findings(measured);
    ASSERT_EQ(said.checks.size(), 5U);
    EXPECT_NEAR(said.checks[0].value, 2.0, 1e-9);
    EXPECT_NEAR(said.checks[0].sigma, 1.0, 1e-9);
    EXPECT_NEAR(said.checks[1].value, 0.0, 1e-9);
    EXPECT_NEAR(said.checks[2].value, 2.0, 1e-9);
    EXPECT_EQ(said.checks[2].verdict(), findings::Verdict::pass);
    EXPECT_EQ(said.checks[3].value, 0.3);
    EXPECT_EQ(said.checks[3].verdict(), findings::Verdict::fail);
    EXPECT_NEAR(said.checks[4].value, 1.4, 1e-9) << "0.7 times 2 %";
    ASSERT_EQ(said.subjects.at(0).pictures.size(), 2U);
    EXPECT_TRUE(says(said.subjects[0].pictures[0].bytes, "Left by waves, right by rays"));
}

TEST(EdgeStudy, ReadsItsTables) {
    const auto complaint = [](const std::string& rest) {
        return complaint_about([&] {
            findings::ExperimentFile file{
                .top = TomlTable::parse("[[edge_diffraction]]\nlens = \"tessar\"\n" + rest, "e.toml")};
            read_edge_diffraction(file);
        });
    };
    EXPECT_EQ(complaint("f_numbers = [8.0, 22.0]\nblades = [0, 5]\n"), "");
    EXPECT_TRUE(says(complaint("f_numbers = [8.0]\nblades = [2]\n"), "e.toml:4: "));
    EXPECT_TRUE(says(complaint("f_numbers = [8.0, 8.0]\nblades = [5]\n"), "tessar-5-blades-f8"));
}

}  // namespace lensproof::studies::edge_study_test
