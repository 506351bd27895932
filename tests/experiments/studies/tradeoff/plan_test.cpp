// tests/experiments/studies/tradeoff/plan_test.cpp — what a plan decides, and that its renders keep their tolerance.
#include "experiments/studies/tradeoff/plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiments/studies/tradeoff/effect_account.h"
#include "tests/complaint.h"
#include "tests/experiments/studies/tradeoff/wall_scene.h"

namespace lensproof::studies::plan_test {

const PlannedEffect& effect(const Plan& plan, const std::string& name) {
    return *std::ranges::find_if(plan.effects,
                                 [&](const PlannedEffect& planned) { return planned.effect.name == name; });
}

TEST(Plan, ToleranceIsReadWithItsUnits) {
    const Tolerance all = parse_tolerance("0.02ev,1e-1px,2de");
    EXPECT_EQ(all.px, 0.1);
    EXPECT_EQ(all.ev, 0.02);
    EXPECT_EQ(all.ciede2000, 2.0);
    EXPECT_TRUE(std::isinf(parse_tolerance("1px").ev));
    EXPECT_EQ(parse_tolerance("visible").ciede2000, 1.0);
    for (const char* wrong : {"", "1", "0.5px,", "-1px", "0ev", "px", "1mm", "1px,2px", "infpx", "nande", "1 de px"}) {
        EXPECT_TRUE(says(complaint_about([&] { parse_tolerance(wrong); }), "--tolerance")) << wrong;
    }
}

// What may be anything is rendered by what is cheapest; what may be nothing by the lens itself.
TEST(Plan, ToleratesAllOrNothing) {
    const render::SceneSetup scene = wall("tessar", 4.5, 20.0);
    const Plan anything = plan_render(scene, {.px = 1e6}, {});
    EXPECT_EQ(anything.render.rung.name, "pinhole");
    EXPECT_EQ(anything.render.rung.wavelengths, 4);
    EXPECT_EQ(anything.render.max_bounces, 1);
    EXPECT_TRUE(anything.render.passes.empty());
    EXPECT_GT(anything.speed_up, 1.0);
    const Plan nothing = plan_render(scene, {.px = 1e-9, .ev = 1e-9, .ciede2000 = 1e-9}, {});
    EXPECT_EQ(nothing.render.rung.name, kReferenceRung);
    EXPECT_FALSE(nothing.render.rung.wavelengths);
    EXPECT_TRUE(effect(nothing, "aberration-blur").is_modelled);
}

// The Tessar's light falls off: a plan that is held to exposures alone takes a pinhole that knows it, and one that is
// held to places alone a pinhole without.
TEST(Plan, TakesWhatTheToleranceAsksFor) {
    const render::SceneSetup scene = wall("tessar", 2.8, 20.0);
    const Plan exposure = plan_render(scene, {.ev = 0.2}, {});
    ASSERT_GT(effect(exposure, "vignetting").effect.contribution.ev.value, 0.1);
    EXPECT_TRUE(effect(exposure, "vignetting").is_modelled);
    EXPECT_FALSE(effect(exposure, "defocus").is_modelled);
    EXPECT_FALSE(effect(plan_render(scene, {.px = 30.0}, {}), "vignetting").is_modelled);
}

// Against the full model with seeds that no plan saw: no more than the tolerance and two standard errors, which are
// small enough beside it for a model that lacks what matters to be found out.
TEST(Plan, RendersKeepTheirTolerance) {
    const Tolerance tolerance{.px = 2.0, .ev = 0.1, .ciede2000 = 3.0};
    PilotSettings other{.samples = 64};
    other.probe.seed = 1000;
    for (const render::SceneSetup& scene :
         {wall("tessar", 4.5, 10.0), wall("double-gauss-lowenthal", 4.0, 8.0), wall("muller-fisheye", 8.0, 2.0)}) {
        const Contribution found = check_plan(scene, plan_render(scene, tolerance, {}).render, {}, other).error;
        EXPECT_TRUE(keeps(surely(found), tolerance)) << scene.camera.lens;
        EXPECT_LT(found.px.standard_error, 0.2 * tolerance.px) << scene.camera.lens;
        EXPECT_LT(found.ev.standard_error, 0.2 * tolerance.ev) << scene.camera.lens;
        EXPECT_LT(found.ciede2000.standard_error, 0.5 * tolerance.ciede2000) << scene.camera.lens;
    }
}

// Predicted by a few rays, measured by models with it and without, with other seeds: a pinhole's light is the closed
// form, its profile's the integral over the lens's region; places are told by the lens at f/64, whose own blur is no
// more than a quarter of what it is at f/16, a hundredth of a pixel. Two standard errors of eight repetitions hold the
// difference in 91 of 100 cases (Student's t), three in 98; the profile's light is known to 1e-3 EV.
TEST(EffectAccount, MeasuresWhatWasPredicted) {
    PilotSettings other{.samples = 64};
    other.probe.seed = 1000;
    const auto accounts_of = [&](const render::SceneSetup& scene) {
        return account_effects(scene, plan_render(scene, {.px = 30.0}, {}), other);
    };
    const auto named = [](const std::vector<EffectAccount>& accounts, const char* effects) {
        return *std::ranges::find(accounts, effects, &EffectAccount::effects);
    };
    const std::vector<EffectAccount> tessar = accounts_of(wall("tessar", 2.8, 20.0));
    const std::vector<EffectAccount> gauss = accounts_of(wall("double-gauss-lowenthal", 2.0, 12.0));
    for (const std::vector<EffectAccount>& accounts : {tessar, gauss}) {
        const EffectAccount field = named(accounts, "distortion, lateral-colour, vignetting");
        const Measured& predicted = field.predicted.ev;
        EXPECT_GT(predicted.value, 0.05);
        EXPECT_LT(predicted.standard_error, 0.05 * predicted.value);
        EXPECT_NEAR(field.measured.ev.value, predicted.value, 3.0 * predicted.standard_error + 1e-3);
        EXPECT_NEAR(field.measured.px.value, field.predicted.px.value, 0.01);
        const EffectAccount blur = named(accounts, "aberration-blur, axial-colour");
        EXPECT_GT(blur.predicted.px.value, 0.1);
        EXPECT_TRUE(covers(blur.predicted.px, blur.measured.px, false, 3.0 * blur.predicted.px.standard_error + 0.01))
            << blur.predicted.px.value << " " << blur.measured.px.value;
    }
    const EffectAccount ghosts = named(tessar, "ghosts");
    EXPECT_LT(ghosts.predicted.ev.standard_error, 0.5 * ghosts.predicted.ev.value);
    EXPECT_TRUE(covers(ghosts.predicted.ev, ghosts.measured.ev, ghosts.is_bound, 0.0));
}

// A ray's transverse aberration in third order goes with the cube, the square and the first power of the aperture, and
// so do the parts of a blur; a plan has them or not as it has all of it.
TEST(Plan, BlursPartsGoWithTheAperture) {
    const Plan open = plan_render(wall("tessar", 5.6, 10.0), {.px = 1e-9}, {});
    const Plan closed = plan_render(wall("tessar", 11.2, 10.0), {.px = 1e-9}, {});
    const auto ratio = [&](const char* name) {
        return effect(open, name).effect.contribution.px.value / effect(closed, name).effect.contribution.px.value;
    };
    EXPECT_NEAR(ratio("spherical-aberration"), 8.0, 1e-6);
    EXPECT_NEAR(ratio("coma"), 4.0, 1e-6);
    EXPECT_NEAR(ratio("astigmatism"), 2.0, 1e-6);
    EXPECT_NEAR(ratio("field-curvature"), 2.0, 1e-6);
    EXPECT_TRUE(effect(open, "coma").is_modelled);
    EXPECT_FALSE(effect(plan_render(wall("tessar", 5.6, 10.0), {.px = 1e6}, {}), "coma").is_modelled);
}

// Where nothing but the electrons' own number is uncertain, noise falls with the root of how many fill the well.
TEST(Plan, TheSensorsNoiseIsThatOfItsElectrons) {
    const auto noise_ev = [](double full_well) {
        render::SceneSetup scene = wall("tessar", 4.5, 10.0);
        scene.sensor = render::RawSensor{.full_well_electrons = full_well,
                                         .white_level_dn = 1 << 30,
                                         .camera = {.exposure = scene.camera.exposure},
                                         .neutral = {1.0, 1.0, 1.0}};
        return effect(plan_render(scene, {.px = 1e6}, {}), "sensor").effect.contribution.ev.value;
    };
    const double many = noise_ev(1e8);
    EXPECT_GT(many, 0.0);
    EXPECT_NEAR(noise_ev(1e6) / many, 10.0, 0.1);  // log2(1 + x) is x / ln 2 to half of x, here a hundredth at most
}

TEST(EffectAccount, CoversWithinTwoErrorsOfBoth) {
    EXPECT_TRUE(covers({1.0, 0.3}, {1.9, 0.4}, false, 0.0));
    EXPECT_FALSE(covers({1.0, 0.3}, {2.1, 0.4}, false, 1.0));
    EXPECT_TRUE(covers({1.0, 0.3}, {2.1, 0.4}, false, 1.2)) << "too little to matter";
    EXPECT_FALSE(covers({2.1, 0.3}, {1.0, 0.4}, false, 0.0));
    EXPECT_TRUE(covers({2.1, 0.3}, {1.0, 0.4}, true, 0.0)) << "a bound that is not reached";
}

TEST(Plan, NeedsALens) {
    render::SceneSetup scene = wall("tessar", 4.5, 20.0);
    scene.camera.lens.clear();
    scene.camera.focal_length_mm = 50.0;
    EXPECT_TRUE(says(complaint_about([&] { plan_render(scene, {.px = 1.0}, {}); }), "in the place of a lens"));
}

}  // namespace lensproof::studies::plan_test
