// The choice of a lens model.
#include "calibration/geometry/model_choice.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibration/geometry/geometry_json.h"
#include "calibration/geometry/projection_uncertainty.h"
#include "engine/base/input_error.h"
#include "tests/calibration/synthetic.h"
#include "tests/trials.h"

namespace lensproof::calibration::model_choice_test {

using namespace synthetic;

constexpr int kWidth = 640;
constexpr int kHeight = 480;

std::vector<ChartView> noisy_views(const CameraModel& camera, const std::vector<Pose>& poses, double sigma_px,
                                   unsigned seed) {
    const scene::Chart board{.pattern = scene::Checkerboard{10, 7, 30.0}};
    Noise noise(seed);
    std::vector<ChartView> views;
    for (const Pose& pose : poses) {
        views.push_back(view_of(camera, pose, board));
        for (Vec2d& p : views.back().image_px) {
            p.x += sigma_px * noise();
            p.y += sigma_px * noise();
        }
    }
    return views;
}

const ModelCandidate& candidate(const ModelChoice& choice, const std::string& name) {
    for (const ModelCandidate& c : choice.candidates) {
        if (c.name == name) {
            return c;
        }
    }
    throw InputError("no candidate " + name);
}

std::vector<Pose> thirteen_poses(double distance, double tilt, double shift) {
    std::vector<Pose> poses = tilted_poses(distance, tilt, shift);
    for (const Pose& pose : tilted_poses(1.2 * distance, 0.7 * tilt, 1.3 * shift)) {
        poses.push_back(pose);
    }
    for (int i = 0; i < 3; ++i) {
        poses.push_back({{0.1 * i, tilt, 0.3 * i}, {0.4 * shift * i, -0.5 * shift, 0.9 * distance}});
    }
    return poses;
}

// A strong fisheye is no perspective camera: the held-out error says so, and the words too.
TEST(CalibrationModelChoice, AFisheyeIsNotTakenForAPerspectiveCamera) {
    const auto views = noisy_views(fisheye_camera(), thirteen_poses(130.0, 0.5, 60.0), 0.05, 1);
    const ChosenGeometry chosen = choose_model(views, kWidth, kHeight, {});
    EXPECT_FALSE(is_perspective(chosen.fit.model) && kind(chosen.fit.model) != ModelKind::division);
    const ModelCandidate& taken = chosen.choice.candidates[static_cast<std::size_t>(chosen.choice.chosen)];
    // Noise of both coordinates, 0.05 √2, and the pose's part of it (6 of 108 numbers).
    EXPECT_NEAR(taken.held_out_rms_px, 0.05 * std::sqrt(2.0), 0.006);
    const ModelCandidate& brown = candidate(chosen.choice, "brown-conrady with 2 radial terms");
    EXPECT_GT(brown.refused.empty() ? brown.held_out_rms_px : 1.0, 1.5 * taken.held_out_rms_px);
    EXPECT_NE(chosen.choice.why.find("brown-conrady with 2 radial terms"), std::string::npos);
}

// Few views in the middle of the frame: eight coefficients leave the same residuals as four, and no idea of the
// corners. The known trap: a rational function with k1 = 9 ± 44 and an error of 1.4 px there, or (in half of all
// draws of the noise) one whose focal length a fifth of the views less does not tell to 5 %, which is refused.
TEST(CalibrationModelChoice, AModelThatDoesNotKnowItsCornersLoses) {
    BrownConrady truth = perspective_camera();
    truth.parameters[5] = 0.0;
    const auto views = noisy_views(truth, tilted_poses(1100.0, 0.5, 80.0), 0.1, 1);
    const ChosenGeometry chosen = choose_model(views, kWidth, kHeight, {});
    const ModelCandidate& taken = chosen.choice.candidates[static_cast<std::size_t>(chosen.choice.chosen)];
    const ModelCandidate& rational = candidate(chosen.choice, "brown-conrady-rational");
    EXPECT_LE(taken.parameters, 8);
    ASSERT_TRUE(rational.refused.empty());
    EXPECT_NEAR(rational.rms_px, taken.rms_px, 0.05 * taken.rms_px);
    EXPECT_GT(rational.corner_px.value_or(100.0), 3.0 * taken.corner_px.value());
    EXPECT_NE(chosen.choice.why.find("corners"), std::string::npos);
}

TEST(CalibrationModelChoice, TheSameViewsGiveTheSameChoiceAndItsJsonReadsBack) {
    const auto views = noisy_views(perspective_camera(), tilted_poses(600.0, 0.4, 60.0), 0.1, 3);
    const ChosenGeometry a = choose_model(views, kWidth, kHeight, {});
    const ChosenGeometry b = choose_model(views, kWidth, kHeight, {});
    EXPECT_EQ(a.choice, b.choice);
    EXPECT_EQ(parameters(a.fit.model), parameters(b.fit.model));
    const auto json = to_json(a.choice);
    EXPECT_EQ(from_json<ModelChoice>(JsonNode::parse(json.dump(), "memory")), a.choice);
    auto damaged = json;
    damaged["chosen"] = 99;
    EXPECT_THROW(from_json<ModelChoice>(JsonNode::parse(damaged.dump(), "memory")), InputError);
}

// A model with fewer terms has no others: k3 and k4 are 0, not what the fit it started from has there, and it is the
// same fit as from nothing.
TEST(CalibrationModelChoice, ATermThatIsNotFittedIsNotThere) {
    const std::vector<Pose> poses = thirteen_poses(130.0, 0.5, 60.0);
    const auto views = noisy_views(fisheye_camera(), poses, 0.05, 1);
    GeometryOptions options;
    options.model = ModelKind::kannala_brandt;
    const GeometryFit four = fit_geometry(views, kWidth, kHeight, options);
    ASSERT_NE(parameters(four.model)[6], 0.0);
    options.radial_terms = 2;
    const GeometryFit two = refit_geometry(views, kWidth, kHeight, options, state_of(four));
    const GeometryFit from_nothing = fit_geometry(views, kWidth, kHeight, options);
    EXPECT_EQ(parameters(two.model)[5], 0.0);
    EXPECT_EQ(parameters(two.model)[6], 0.0);
    // The solver stops at a relative change of 1e-14 of the sum of squares, which has its least value there.
    EXPECT_NEAR(two.rms_px, from_nothing.rms_px, 1e-9);
    EXPECT_GT(two.rms_px, four.rms_px);
}

// What is said of places beyond the charts holds, whatever the truth has there: charts in the middle of a fisheye's
// frame, which cannot tell two terms from four, or four from the division model. What is chosen would know the outer
// place to 0.3 px (0.5 px), were it the truth; where it is not, it is off by 1 px (13 px). The stated deviation is that
// of the worst direction; an error has two, and its square is 1 to 2 times the stated one, 2 ± 2 in one draw. A place
// that is known to 5 % of half the diagonal or worse is one that the profile calls unknown.
TEST(CalibrationModelChoice, WhatIsChosenKnowsWhatItDoesNotKnow) {
    struct Case {
        KannalaBrandt truth;
        double noise_px;
        bool is_simple;  // enough for the model that is chosen
    };
    KannalaBrandt two_terms = fisheye_camera();
    two_terms.parameters[5] = two_terms.parameters[6] = 0.0;
    const KannalaBrandt wide{{208.6, 322.0, 236.0, 0.0028, -0.0091, 0.0032, -0.0012}};  // the fisheye board's camera
    const std::array cases{Case{two_terms, 0.05, true}, Case{fisheye_camera(), 0.05, false}, Case{wide, 0.3, false}};
    const std::array places{Vec2d{100.0, 80.0}, Vec2d{170.0, 130.0}};
    const double unknown_px = 0.05 * 0.5 * std::hypot(kWidth, kHeight);
    const std::vector<Pose> poses = thirteen_poses(220.0, 0.4, 50.0);
    const int draws = trials(30, 3);
    for (const Case& c : cases) {
        std::array<double, 2> mean{};
        double by_noise = 0.0;  // at the outer place, by the noise's deviation alone
        int unknown = 0;
        for (int draw = 0; draw < draws; ++draw) {
            const auto views = noisy_views(c.truth, poses, c.noise_px, 100 + static_cast<unsigned>(draw));
            const ChosenGeometry chosen = choose_model(views, kWidth, kHeight, {});
            for (std::size_t k = 0; k < places.size(); ++k) {
                const double noise = projection_uncertainty_px(chosen.fit, places[k]).value();
                const double stated =
                    std::hypot(noise, models_disagreement_px(chosen.fit, chosen.rivals, places[k]).value_or(0.0));
                const Vec2d again = imaged_again(poses, chosen.fit, unproject(c.truth, places[k]).value(), true);
                const double error = std::hypot(again.x - places[k].x, again.y - places[k].y);
                mean[k] += stated < unknown_px ? std::pow(error / stated, 2) / draws : 0.0;
                unknown += stated < unknown_px ? 0 : 1;
                by_noise += k == 0 ? std::pow(error / noise, 2) / draws : 0.0;
            }
        }
        fmt::print("squared error over the stated one: {:.2f} and {:.2f}, {} of {} unknown; {:.1f} by noise alone\n",
                   mean[0], mean[1], unknown, 2 * draws, by_noise);
        for (const double m : mean) {
            EXPECT_LT(m, 2.0 + 3.0 * 2.0 / std::sqrt(draws));
        }
        EXPECT_LT(unknown, draws);
        EXPECT_TRUE(c.is_simple || by_noise > 2.0 + 3.0 * 2.0 / std::sqrt(draws)) << by_noise;
    }
}

// The map has both parts, and a reader of the choice is told.
TEST(CalibrationModelChoice, RivalsWidenTheMap) {
    const auto views = noisy_views(fisheye_camera(), thirteen_poses(220.0, 0.4, 50.0), 0.05, 1);
    const ChosenGeometry chosen = choose_model(views, kWidth, kHeight, {});
    ASSERT_FALSE(chosen.rivals.empty());
    const UncertaintyMap noise = uncertainty_map(chosen.fit, views, kWidth, kHeight, {}, 5);
    const UncertaintyMap both = uncertainty_map(chosen.fit, views, kWidth, kHeight, chosen.rivals, 5);
    ASSERT_EQ(both.models_px.size(), both.far_px.size());
    for (std::size_t i = 0; i < both.far_px.size(); ++i) {
        EXPECT_DOUBLE_EQ(both.far_px[i].value(), std::hypot(noise.far_px[i].value(), both.models_px[i].value_or(0.0)));
    }
    EXPECT_TRUE(noise.models_px.empty());
    EXPECT_GT(chosen.choice.corner_disagreement_px.value(), both.models_px[both.models_px.size() / 2].value());
    EXPECT_NE(chosen.choice.why.find("those that predict as well differ there"), std::string::npos);
    for (const UncertaintyMap& map : {noise, both}) {
        const auto json = to_json(map);
        EXPECT_EQ(to_json(from_json<UncertaintyMap>(JsonNode::parse(json.dump(), "memory"))), json);
    }
}

// One tilted view still has a held-out error: of its own points.
TEST(CalibrationModelChoice, ASingleViewIsSplitByItsPoints) {
    const auto views = noisy_views(perspective_camera(), {Pose{{0.5, -0.4, 0.0}, {0.0, 0.0, 500.0}}}, 0.05, 4);
    GeometryOptions options;
    options.fix_centre = true;
    options.fit_tangential = false;
    const ChosenGeometry chosen = choose_model(views, kWidth, kHeight, options);
    const ModelCandidate& taken = chosen.choice.candidates[static_cast<std::size_t>(chosen.choice.chosen)];
    EXPECT_GT(taken.held_out_rms_px, taken.rms_px);
    EXPECT_FALSE(taken.halves_px);
}

}  // namespace lensproof::calibration::model_choice_test
