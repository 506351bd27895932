// tests/experiments/studies/stray_light/measured_chart_test.cpp — [stray_light.chart] as a file states it, and its
// verdicts on features that are known.
#include "experiments/studies/stray_light/measured_chart.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/complaint.h"

namespace lensproof::studies::measured_chart_test {

MeasuredChart read(const std::string& text) {
    TomlTable top = TomlTable::parse("[chart]\n" + text, "experiment.toml");
    return read_measured_chart(top.table("chart"), {"near", "far"});
}

/// Thirty features whose pictures' widths are off by ±0.1 µm, and in the outer third by `off` more.
VariantFeatures features(double off) {
    VariantFeatures variant{.name = "near", .label = "near", .features = {}};
    for (int i = 0; i < 30; ++i) {
        ChartFeature feature{.field_deg = 1.0 * i, .picture = {}, .rays = {}};
        feature.rays.sagittal_um = 40.0;
        feature.picture.sagittal_um = 40.0 + (i % 2 == 0 ? 0.1 : -0.1) + (i >= 20 ? off : 0.0);
        variant.features.push_back(feature);
    }
    return variant;
}

TEST(MeasuredChart, HoldsTheWorstThirdOfTheField) {
    const MeasuredChart chart = read(
        "agrees = { sagittal_um = 1.0 }\n"
        "[[chart.checks]]\nmeasure = \"sagittal_um\"\nof = \"near\"\n"
        "field_deg = [20, 29]\nat_least = 40.5\n");
    const auto checks = [&](double off, findings::Quality quality) {
        return chart_checks(chart, "dots", "Dots", {features(off)}, quality);
    };
    const std::vector<findings::Check> held = checks(-0.6, findings::Quality::full);
    ASSERT_EQ(held.size(), 2U);
    EXPECT_EQ(held[0].id, "dots-chart-1");
    EXPECT_EQ(held[0].subject, "dots-near");
    EXPECT_NEAR(held[0].value, -0.6, 1e-12);
    EXPECT_NEAR(held[0].sigma, 0.1 / 3.0, 1e-12);  // of ten, half 0.1 above and half below
    EXPECT_EQ(held[0].verdict(), findings::Verdict::pass);
    EXPECT_EQ(held[1].verdict(), findings::Verdict::fail);
    EXPECT_EQ(checks(1.5, findings::Quality::full)[0].verdict(), findings::Verdict::fail);
    EXPECT_EQ(checks(1.5, findings::Quality::full)[1].verdict(), findings::Verdict::pass);
    EXPECT_EQ(checks(1.5, findings::Quality::draft)[0].verdict(), findings::Verdict::pass);
    EXPECT_EQ(checks(9.0, findings::Quality::draft)[0].verdict(), findings::Verdict::fail);
}

// Nothing is held where a feature could not be measured, or where there are so few that nobody knows their scatter.
TEST(MeasuredChart, HoldsNothingThatIsNotKnown) {
    const MeasuredChart chart = read("agrees = { sagittal_um = 1.0 }\n");
    const auto verdict = [&](const VariantFeatures& variant) {
        return chart_checks(chart, "dots", "Dots", {variant}, findings::Quality::full).at(0).verdict();
    };
    for (const std::size_t where : {0U, 15U, 29U}) {
        VariantFeatures unmeasured = features(0.0);
        unmeasured.features[where].picture.sagittal_um = std::nan("");
        EXPECT_EQ(verdict(unmeasured), findings::Verdict::inconclusive) << where;
    }
    VariantFeatures few = features(0.0);
    few.features.resize(2);
    EXPECT_EQ(verdict(few), findings::Verdict::inconclusive);
}

TEST(MeasuredChart, SaysWhatItDoesNotKnow) {
    EXPECT_TRUE(says(complaint_about([] { read("agrees = {}\n"); }), "agrees: says nothing"));
    EXPECT_TRUE(says(complaint_about([] { read("agrees = { width_um = 1.0 }\n"); }), "experiment.toml:2: "));
    EXPECT_TRUE(says(complaint_about([] {
                         read(
                             "agrees = { light = 0.1 }\n[[chart.checks]]\nmeasure = \"light\"\nof = \"middle\"\n"
                             "field_deg = [0, 5]\nat_most = 1\n");
                     }),
                     "of: is \"middle\", expected one of: near, far"));
}

}  // namespace lensproof::studies::measured_chart_test
