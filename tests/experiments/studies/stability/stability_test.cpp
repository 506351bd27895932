// The tracer's requirement at each extreme, on a part of experiments/stability.toml's sweeps, and how a sweep becomes
// checks and a report.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "experiments/studies/stability/measure_stability.h"
#include "experiments/studies/stability/stability_study.h"
#include "tests/complaint.h"

namespace lensproof::studies {

/// How GoogleTest names a case's parameter.
static void PrintTo(const Extreme& extreme, std::ostream* out) {
    *out << extreme.id;
}

}  // namespace lensproof::studies

namespace lensproof::studies::stability_test {
namespace {

/// A few values of the sweep, its ends among them, with a few rays each: what a hundred digits do in a fraction of a
/// second.
Extreme reduced(Extreme extreme) {
    constexpr std::size_t kValues = 6;
    if (extreme.id == "surfaces") {
        extreme.values.resize(5);  // up to 50
    }
    constexpr std::size_t kRays = 3;
    std::vector<double> values;
    for (std::size_t i = 0; i < kValues; ++i) {
        values.push_back(extreme.values[i * (extreme.values.size() - 1) / (kValues - 1)]);
    }
    extreme.values = values;
    extreme.build = [build = extreme.build](double value, std::mt19937_64& random) {
        StabilityCase made = build(value, random);
        made.rays.resize(kRays);
        return made;
    };
    return extreme;
}

class StabilityExtremes : public testing::TestWithParam<Extreme> {};

// Below 1e-9 mm or ten times the conditioning, never NaN, the right status; and packets agree with
// scalars.
TEST_P(StabilityExtremes, ADoubleHoldsItsBound) {
    const StabilitySweep sweep = measure_stability(reduced(GetParam()), 7);
    EXPECT_EQ(findings::overall(stability_checks({sweep})), findings::Verdict::pass);
    int traced = 0;
    for (const StabilityPoint& point : sweep.points) {
        SCOPED_TRACE(point.value);
        traced += point.rays;
        EXPECT_LE(point.excess, 1.0);
        EXPECT_EQ(point.types[kDouble].other_statuses, 0);
        EXPECT_EQ(point.lanes_unlike_scalar, 0);
        for (const TypeResult& result : point.types) {
            EXPECT_EQ(result.not_finite, 0);
        }
        EXPECT_LE(point.types[kLongDouble].error_mm,
                  std::max(kErrorBoundMm, kConditioningFactor * point.conditioning_mm));
    }
    EXPECT_GT(traced, 0);
}

std::string id_of(const testing::TestParamInfo<Extreme>& info) {
    std::string id = info.param.id;
    std::erase(id, '-');
    return id;
}

INSTANTIATE_TEST_SUITE_P(All, StabilityExtremes, testing::ValuesIn(stability_extremes()), id_of);

/// A tracer that is off by a micrometre, as the judge would see it.
StabilitySweep failing_sweep() {
    StabilitySweep sweep{.extreme = stability_extremes().front(), .points = {}};
    for (const double value : {1.0, 10.0, 100.0, kInfinity}) {
        StabilityPoint point{.value = value, .rays = 2};
        point.fates = {{"ok", 2}};
        point.conditioning_mm = 1e-14;
        point.types[kDouble].error_mm = value > 5.0 && value < 1e3 ? 1e-3 : 1e-14;
        point.excess = point.types[kDouble].error_mm / kErrorBoundMm;
        sweep.points.push_back(point);
    }
    StabilityPoint refused{.value = 1e-4, .refusal = "radius_mm is too small"};
    sweep.points.push_back(refused);
    return sweep;
}

TEST(StabilityReport, AnErrorOverItsBoundFails) {
    const std::vector<StabilitySweep> sweeps{failing_sweep()};
    EXPECT_EQ(findings::overall(stability_checks(sweeps)), findings::Verdict::fail);
    const std::optional<Onset> onset = onset_of_trouble(sweeps.front(), kDouble);
    ASSERT_TRUE(onset);
    EXPECT_EQ(onset->from, 10.0);
    EXPECT_EQ(onset->to, 100.0);
    EXPECT_EQ(onset->largest_mm, 1e-3);
    EXPECT_FALSE(onset->is_conditioning);
    EXPECT_FALSE(onset_of_trouble(sweeps.front(), kLongDouble));
}

TEST(StabilityReport, AWrongStatusOrANaNFails) {
    for (const bool is_status : {true, false}) {
        StabilitySweep sweep = failing_sweep();
        for (StabilityPoint& point : sweep.points) {
            point.excess = 0.0;
        }
        EXPECT_EQ(findings::overall(stability_checks({sweep})), findings::Verdict::pass);
        (is_status ? sweep.points[1].types[kDouble].other_statuses : sweep.points[1].types[kDouble].not_finite) = 1;
        EXPECT_EQ(findings::overall(stability_checks({sweep})), findings::Verdict::fail);
    }
}

TEST(StabilityReport, ARefusalThatIsNotMeantFails) {
    StabilitySweep sweep = failing_sweep();
    for (StabilityPoint& point : sweep.points) {
        point.excess = 0.0;
    }
    sweep.points.back().is_rightly_refused = false;
    EXPECT_EQ(findings::overall(stability_checks({sweep})), findings::Verdict::fail);
}

TEST(StabilityReport, SaysWhatTheProgramDoes) {
    const std::vector<StabilitySweep> sweeps{failing_sweep()};
    const findings::Findings found = stability_findings(sweeps);
    EXPECT_EQ(findings::overall(found.checks), findings::Verdict::fail);
    const auto& [key, extremes] = found.tables.at(0);
    EXPECT_EQ(key, "extremes");
    EXPECT_EQ(extremes[0]["points"][3]["value"], "inf");
    EXPECT_EQ(extremes[0]["points"][4]["refusal"], "radius_mm is too small");
    EXPECT_EQ(extremes[0]["points"][0]["statuses"]["ok"], 2);
    EXPECT_EQ(extremes[0]["onset"]["double"]["from"], 10.0);
    EXPECT_TRUE(extremes[0]["onset"]["float"].is_null());
    std::string facts;
    for (const findings::Fact& fact : found.subjects.at(0).facts) {
        facts += fact.label + ": " + fact.value + "\n";
    }
    EXPECT_TRUE(says(facts, "refused: radius_mm is too small"));
    EXPECT_TRUE(says(facts, "over 1e-09 mm at 10 mm … 100 mm"));
    EXPECT_TRUE(says(stability_chart(sweeps.front()), "<svg"));
}

// The same seed gives the same numbers, another one other rays.
TEST(StabilityReport, RepeatsItselfFromItsSeed) {
    Extreme extreme = reduced(stability_extremes().front());
    extreme.values.resize(2);
    const auto conditioning = [&](std::uint64_t seed) {
        return measure_stability(extreme, seed).points.back().conditioning_mm;
    };
    EXPECT_EQ(conditioning(3), conditioning(3));
    EXPECT_NE(conditioning(3), conditioning(4));
}

}  // namespace
}  // namespace lensproof::studies::stability_test
