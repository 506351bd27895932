// What explains simulated profiles of lenses whose faults are known.
#include "calibration/explain/explanation.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ostream>

#include "engine/base/input_error.h"
#include "tests/calibration/explain/simulated_profile.h"
#include "tests/trials.h"

namespace lensproof::calibration::explanation_test {

using explain_test::Faults;
using explain_test::image_points;
using explain_test::simulated_profile;
using explain_test::Studio;

LensExplanation explained(const Studio& studio, const Profile& profile, const std::string& lens) {
    return explain(formats::load_lens(lens), {{"profile.json", profile}},
                   {.free = studio.free, .focus_mm = studio.distance_mm});
}

/// Whether a cause is named, first or among those that are nearly as likely.
bool names(const LensExplanation& found, const std::string& cause) {
    return found.cause == cause || std::ranges::find(found.other_causes, cause) != found.other_causes.end();
}

const ExplainedChange& parameter(const LensExplanation& found, const std::string& name) {
    return *std::ranges::find_if(found.parameters, [&](const ExplainedChange& of) { return of.change.name == name; });
}

const Studio kBiotar{.lens = "biotar", .distance_mm = 1000.0};

struct Trial {
    const char* name;
    Studio studio;
    Faults faults;
    std::string cause;
};

void PrintTo(const Trial& trial, std::ostream* out) {
    *out << trial.name;
}

/// Counts over all faults, where they are tried in one run of the program.
class ExplainedFaults : public testing::TestWithParam<Trial> {
  protected:
    static void TearDownTestSuite() {
        fmt::print("{} of {} faults named\n", named_, tried_);
        if (tried_ >= 20U) {
            EXPECT_GE(20U * named_, 18U * tried_);
        }
    }
    static void count(bool is_named) {
        named_ += is_named ? 1U : 0U;
        ++tried_;
    }

  private:
    static inline unsigned named_ = 0;
    static inline unsigned tried_ = 0;
};

// Four seeds of each of five faults: of the twenty, eighteen have to be named. Each may miss at most one of four, and
// its values lie within three standard errors, where they are those of the cause named first; of a normal distribution
// 0.3 % do not.
TEST_P(ExplainedFaults, AreNamedWithinTheirErrors) {
    const Trial& trial = GetParam();
    // As prescribed the lens leaves more than noise: of n points' mean square that is known to 1 / √n.
    const auto prescribed = prescribed_residual(formats::load_lens(trial.studio.lens),
                                                {"profile.json", simulated_profile(trial.studio, trial.faults, 1)},
                                                trial.studio.distance_mm);
    ASSERT_TRUE(prescribed);
    EXPECT_GT(std::pow(prescribed->rms_um / prescribed->noise_um, 2), 1.0 + 3.0 / std::sqrt(prescribed->points));
    unsigned named = 0;
    const unsigned seeds = trials(4U, 1U);
    for (unsigned seed = 1; seed <= seeds; ++seed) {
        const LensExplanation found =
            explained(trial.studio, simulated_profile(trial.studio, trial.faults, seed), trial.studio.lens);
        EXPECT_EQ(fit_verdict_name(found.verdict), std::string("explained")) << found.reason;
        EXPECT_LT(found.rms_um_after, 1.1 * found.noise_um);
        const bool is_named = names(found, trial.cause);
        count(is_named);
        named += is_named ? 1U : 0U;
        for (const auto& [name, value] : trial.faults) {
            const ExplainedChange& of = parameter(found, name);
            if (found.cause == trial.cause) {
                EXPECT_NEAR(of.value, value, 3.0 * of.standard_error) << name << ", seed " << seed;
            }
        }
    }
    EXPECT_GE(4 * named, 3 * seeds);
}

INSTANTIATE_TEST_SUITE_P(
    , ExplainedFaults,
    testing::Values(Trial{"Focus", {}, {{"focus_mm", 1.5}}, "the focus"},
                    Trial{"DecentredGroup", {}, {{"decentre_y_5_6_mm", 0.3}}, "surfaces 5 to 6 are decentred"},
                    Trial{"TiltedSensor", {}, {{"sensor_tilt_x_deg", 1.2}}, "the sensor is tilted"},
                    Trial{"WrongGlass", {}, {{"n_d_1", -0.03}, {"V_d_1", 5.0}}, "the glass behind surface 1"},
                    Trial{"ExchangedGaps",
                          {},
                          {{"gap_3_mm", 6.48}, {"gap_6_mm", -6.48}},
                          "the gaps behind surfaces 3 and 6 are exchanged"}),
    [](const testing::TestParamInfo<Trial>& trial) { return trial.param.name; });

// The prescription itself, through noise: nothing is claimed.
TEST(Explanation, NoiseAloneIsNotExplained) {
    for (const Studio& studio : {Studio{}, kBiotar}) {
        for (unsigned seed = 11; seed < 11 + trials(2U, 1U); ++seed) {
            const LensExplanation found = explained(studio, simulated_profile(studio, {}, seed), studio.lens);
            EXPECT_EQ(found.verdict, FitVerdict::unexplained) << found.reason;
            EXPECT_EQ(found.cause, "");
            EXPECT_LT(std::abs(found.held_out.significance), 3.0);
            const auto prescribed =
                prescribed_residual(formats::load_lens(studio.lens),
                                    {"profile.json", simulated_profile(studio, {}, seed)}, studio.distance_mm);
            ASSERT_TRUE(prescribed);
            EXPECT_LT(prescribed->rms_um, 1.1 * prescribed->noise_um);
        }
    }
}

// Another double Gauss of the same focal length, of 50 mm.
TEST(Explanation, AnotherLensOfTheSameFocalLengthIsNotThisLens) {
    const LensExplanation found = explained(kBiotar, simulated_profile(kBiotar, {}, 5), "nikkor-50");
    EXPECT_EQ(found.verdict, FitVerdict::not_this_lens) << found.reason;
    EXPECT_EQ(found.cause, "");
    EXPECT_GT(found.largest_strain, 4.0);
}

// Focus and scale magnify alike: with nothing else free, their combination that leaves the picture's size is all but
// open, and the standard error of each is far above that of their sum.
TEST(Explanation, FocusAndScaleCannotBeToldApart) {
    Studio studio;
    studio.free = {"focus"};
    const LensExplanation found = explained(studio, simulated_profile(studio, {{"focus_mm", 0.5}}, 7), "tessar");
    ASSERT_EQ(found.undetermined.size(), 1U);
    const OpenCombination& open = found.undetermined.front();
    ASSERT_EQ(open.direction.size(), 2U);
    // Δh / h is Δfocus / 105 mm, the image's distance here, and is taken back by scale: 0.2 mm of focus are 1.9
    // tolerances of scale, so that the open direction has components of 1 to 1.9.
    const auto component = [&](const std::string& name) {
        return std::ranges::find(open.direction, name, &std::pair<std::string, double>::first)->second;
    };
    EXPECT_NEAR(component("focus_mm") / component("scale"), -0.53, 0.06);
    EXPECT_FALSE(parameter(found, "scale").determined);
}

// In 200 trials all changes are drawn from what is believed of them, and 95 % of the intervals should hold the truth:
// of 200 × 29 intervals, which hang together within a trial, 90 to 99 % do.
TEST(LensFit, IntervalsHoldTheTruth) {
    Studio studio;
    studio.columns = 6;
    studio.rows = 4;
    SeenPoints seen = studio_points(studio);
    const ExplainedLens lens = explained_lens(formats::load_lens(studio.lens), seen, studio.free, studio.distance_mm);
    const Belief belief = usual_belief(lens.changes);
    int held = 0;
    int count = 0;
    for (unsigned seed = 0; seed < trials(200U, 40U); ++seed) {
        synthetic::Noise draw(seed + 5000);
        Eigen::VectorXd truth = belief.mean;
        for (Eigen::Index i = 0; i < truth.size(); ++i) {
            truth[i] += belief.sigma[i] * draw();
        }
        image_points(lens, truth, seed, seen);
        const auto fit = fit_lens(lens, seen, start_of(lens, seen), belief);
        ASSERT_TRUE(fit);
        const Eigen::MatrixXd covariance = fit->covariance();
        for (Eigen::Index i = 0; i < truth.size(); ++i) {
            held += std::abs(fit->state.changes[i] - truth[i]) <= 1.96 * std::sqrt(covariance(i, i)) ? 1 : 0;
            ++count;
        }
    }
    EXPECT_GT(held, 0.9 * count);
    EXPECT_LT(held, 0.99 * count);
}

// What cannot be used is refused, and said.
TEST(Explanation, NamesWhatItCannotUse) {
    const Studio studio;
    const optics::Lens lens = formats::load_lens("tessar");
    const NamedProfile good{"good.json", simulated_profile(studio, {}, 3)};
    const auto message = [&](const std::vector<NamedProfile>& profiles, const ExplainSettings& settings) {
        try {
            explain(lens, profiles, settings);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    NamedProfile other = good;
    other.file = "other.json";
    other.profile.width_px = 5000;
    EXPECT_NE(message({good, other}, {}).find("other.json is of another camera than good.json"), std::string::npos);
    NamedProfile without = good;
    without.profile.pixel_pitch_um.reset();
    EXPECT_NE(message({without}, {}).find("pixel_pitch_um"), std::string::npos);
    without = good;
    without.profile.views.clear();
    EXPECT_NE(message({without}, {}).find("no views"), std::string::npos);
    EXPECT_NE(message(std::vector<NamedProfile>(41, good), {}).find("41 profiles, expected 40 at most"),
              std::string::npos);
    EXPECT_NE(message({good}, {.free = {"stop"}}).find("--free is \"stop\", expected focus"), std::string::npos);
}

// Two profiles of one lens at two focuses: each focus is found, and what is common is known better than from one.
TEST(Explanation, SeveralProfilesHaveOneLens) {
    Studio studio;
    studio.free = {"focus", "gaps", "decentre"};
    const Profile one = simulated_profile(studio, {{"decentre_y_5_6_mm", 0.1}}, 21);
    const Profile two = simulated_profile(studio, {{"decentre_y_5_6_mm", 0.1}, {"focus_mm", 0.4}}, 22);
    const optics::Lens lens = formats::load_lens("tessar");
    const ExplainSettings settings{.free = studio.free, .focus_mm = studio.distance_mm};
    const LensExplanation alone = explain(lens, {{"one.json", one}}, settings);
    const LensExplanation both = explain(lens, {{"one.json", one}, {"two.json", two}}, settings);
    const double between = parameter(both, "focus_2_mm").value - parameter(both, "focus_1_mm").value;
    // The difference of two focuses is free of what both share with the scale: it is known to some hundredths of a mm,
    // 0.1 mm being 0.1 % of the picture's size, or half a pixel at its edge.
    EXPECT_NEAR(between, 0.4, 0.15);
    EXPECT_LT(parameter(both, "decentre_y_5_6_mm").standard_error,
              parameter(alone, "decentre_y_5_6_mm").standard_error);
}

}  // namespace lensproof::calibration::explanation_test
