// tests/experiments/studies/tradeoff/spot_check_test.cpp — a plan is held to the scene's own pixels.
#include "experiments/studies/tradeoff/spot_check.h"

#include <gtest/gtest.h>

#include "tests/experiments/studies/tradeoff/wall_scene.h"

namespace lensproof::studies::spot_check_test {

const Tolerance kTolerance{.ev = 0.1, .ciede2000 = 3.0};

Plan plan_of(const render::SceneSetup& scene, const char* rung) {
    Plan plan;
    plan.tolerance = kTolerance;
    plan.render = {.rung = *std::ranges::find(ladder(), rung, &Rung::name), .max_bounces = scene.max_bounces};
    return plan;
}

// Out of focus by half its distance a wall at f/2 is a blur: a pinhole is refused, and so is its profile; a thin lens
// is not.
TEST(SpotCheck, RevisesAPlanThatMisses) {
    render::SceneSetup scene = wall("double-gauss-lowenthal", 2.0, 8.0);
    scene.camera.focus_distance_mm = 1500.0;
    const Plan plan = spot_checked(plan_of(scene, "pinhole"), scene, {});
    EXPECT_TRUE(plan.render.rung.name == "thin-lens" || plan.render.rung.name == "thin-lens-profile");
    EXPECT_TRUE(plan.spots.is_revised);
    ASSERT_FALSE(plan.refused.empty());
    EXPECT_EQ(plan.refused.front().find("pinhole: "), 0U);
    EXPECT_NE(plan.refused.front().find("of the scene's own pixels"), std::string::npos);
    EXPECT_TRUE(keeps(surely(plan.spots.error), kTolerance));
}

TEST(SpotCheck, LeavesAPlanThatKeeps) {
    const render::SceneSetup scene = wall("tessar", 8.0, 10.0);
    const Plan plan = spot_checked(plan_of(scene, "pinhole-profile"), scene, {});
    EXPECT_EQ(plan.render.rung.name, "pinhole-profile");
    EXPECT_FALSE(plan.spots.is_revised);
    EXPECT_TRUE(plan.refused.empty());
    EXPECT_GT(plan.spots.pixels, 1000);
}

// A fiftieth of a large render's samples goes into windows, of which there are then more, each with more of them.
TEST(SpotCheck, IsAsThoroughAsTheRenderAllows) {
    render::SceneSetup scene = wall("tessar", 8.0, 10.0);
    scene.samples_per_pixel = 1;
    const SpotCheckSettings small = SpotCheckSettings::for_render(scene);
    EXPECT_EQ(small.windows, SpotCheckSettings().windows);
    EXPECT_EQ(small.samples, SpotCheckSettings().samples);
    scene.camera.sensor.width = 6000;
    scene.camera.sensor.height = 4000;
    scene.samples_per_pixel = 64;
    const SpotCheckSettings large = SpotCheckSettings::for_render(scene);
    const double taken = 4.0 * large.windows * large.across * large.across * large.samples;
    EXPECT_NEAR(taken, 0.02 * 6000 * 4000 * 64, 0.03 * taken);  // windows and samples are whole numbers
    EXPECT_NEAR(static_cast<double>(large.windows) / small.windows, static_cast<double>(large.samples) / small.samples,
                0.1);
}

// Where no cheaper render is near enough, at last it is the full model: four wavelengths are surely not as bright
// as 16.
TEST(SpotCheck, EndsWithTheFullModel) {
    const render::SceneSetup scene = wall("tessar", 4.5, 10.0);
    Plan plan = plan_of(scene, "thin-lens");
    plan.tolerance = {.ev = 1e-9};
    plan.render.rung.wavelengths = 4;
    plan.render.max_bounces = 1;
    plan = spot_checked(plan, scene, {});
    EXPECT_EQ(plan.render.rung.name, kReferenceRung);
    EXPECT_FALSE(plan.render.rung.wavelengths);
    EXPECT_EQ(plan.render.max_bounces, scene.max_bounces);
}

}  // namespace lensproof::studies::spot_check_test
