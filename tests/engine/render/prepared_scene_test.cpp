#include "engine/render/prepared_scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "engine/base/angle.h"
#include "engine/render/film/film_image.h"
#include "tests/complaint.h"
#include "tests/engine/every_device.h"
#include "tests/test_folder.h"

namespace lensproof::render::prepared_scene_test {
namespace {

/// A sun beside the picture and nothing else: all that reaches the film has gone astray. `camera`, `render`: lines of
/// these tables; `more`: of what there is besides.
SceneSetup under_a_sun(const std::string& camera, const std::string& render = {}, const std::string& more = {}) {
    return parse_scene_setup(camera + R"(
f_number = 5.6
focus_distance_mm = inf
position_mm = [0, 0, 0]
look_at_mm = [0, 0, 1]
sensor_mm = [36, 24]
pixels = [12, 8]
shutter_s = 0.01
iso = 100
response = "luminance"
[render]
)" + render + R"(layers = 4
strata_per_layer = 1
[[lights]]
kind = "sun"
direction = [-0.3, 0.6, 1.0]
illuminance_lx = 1e5
)" + more,
                             "sun.toml");
}

/// The picture of its ghosts.
std::vector<float> astray(const std::string& camera, const Cache& cache, const PixelFilter& filter = {},
                          const std::optional<PixelFilter>& stray_filter = {}) {
    PreparedScene scene(under_a_sun(camera), filter, cache, {}, stray_filter);
    return film_rgb(render_film(scene.render({"ghosts"}, 1, false).front(), {.first = 0, .end = 64}, 1)).pixels;
}

// Whatever stands for the lens where light goes straight, it goes astray in the lens: the same paths, the same bits;
// and so it does where the lens's ghosts are known from the cache.
TEST(PreparedScene, LightGoesAstrayInTheLensBesideAnyModelOfIt) {
    const TestFolder folder;
    const Cache cache(folder.path());
    const std::string camera = "[camera]\nlens = \"tessar\"\n";
    const std::vector<float> exact = astray(camera, Cache());
    EXPECT_GT(std::ranges::count_if(exact, [](float light) { return light > 0.0F; }), 20);
    EXPECT_EQ(astray(camera, cache), exact);
    for (const char* model : {"thin-lens", "pinhole-profile", "exact-float"}) {
        EXPECT_EQ(astray(camera + fmt::format("model = \"{}\"\n", model), cache), exact) << model;
    }
    EXPECT_TRUE(says(complaint_about([&] { astray("[camera]\nmodel = \"thin-lens\"\nfocal_length_mm = 50\n", cache); }),
                     "expected \"exact\""));
}

// They add up, pixel by pixel: a camera of its own has no film of its own.
TEST(PreparedScene, StrayLightIsOnTheFilmOfTheImage) {
    SceneSetup setup = under_a_sun("[camera]\nlens = \"tessar\"\nmodel = \"thin-lens\"\n");
    setup.stray_camera = setup.camera;
    setup.stray_camera->sensor.width *= 2;
    setup.stray_camera->sensor.height *= 2;
    setup.stray_camera->sensor.pixel_pitch_mm *= 0.5;
    PreparedScene scene(setup, PixelFilter{}, Cache());
    const std::vector<Render> renders = scene.render({"imaged", "ghosts"}, 1, false, false);
    EXPECT_EQ(renders.back().film.width, renders.front().film.width);
    EXPECT_EQ(renders.back().film.height, renders.front().film.height);
}

// A filter of its own makes of stray light what it makes of it as everyone's, the same paths and the same bits, and
// leaves all other light to theirs.
TEST(PreparedScene, StrayLightHasAFilterOfItsOwn) {
    const TestFolder folder;
    const Cache cache(folder.path());
    const std::string camera = "[camera]\nlens = \"tessar\"\n";
    const PixelFilter box;
    const PixelFilter gaussian = PixelFilter::named("gaussian");
    const std::vector<float> own = astray(camera, cache, box, gaussian);
    EXPECT_EQ(own, astray(camera, cache, gaussian));
    EXPECT_NE(own, astray(camera, cache));
    PreparedScene scene(under_a_sun(camera), box, cache, {}, gaussian);
    EXPECT_TRUE(scene.render({"imaged", "ghosts"}, 1, false, false).front().film.filter.is_box());
}

// What goes straight is one film, with the bits of the scene's own, and the sum of the two that it may be parted into.
TEST(PreparedScene, StraightLightIsWhatImagesAndWhatIsSeen) {
    const std::string ball =
        "[[materials]]\nname = \"grey\"\nkind = \"diffuse\"\nreflectance = 0.5\n"
        "[[objects]]\nname = \"ball\"\nshape = \"sphere\"\nmaterial = \"grey\"\nradius_mm = 1000\n"
        "translate_mm = [0, 0, 5000]\n";
    PreparedScene scene(under_a_sun("[camera]\nlens = \"tessar\"\n", {}, ball), PixelFilter{}, Cache());
    constexpr SampleRange kSamples{.first = 0, .end = 64};
    const auto rendered = [&](const Render& render) { return film_rgb(render_film(render, kSamples, 1)); };
    const std::vector<float> straight = rendered(scene.render({"straight"}, 1, false).front()).pixels;
    EXPECT_EQ(straight, rendered(scene.render(1, false)).pixels);
    std::vector<double> sums(3);
    const std::vector<Render> parts = scene.render({"imaged", "direct"}, 1, false);
    sums[0] = std::accumulate(straight.begin(), straight.end(), 0.0);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const std::vector<float> part = rendered(parts[i]).pixels;
        sums[1 + i] = std::accumulate(part.begin(), part.end(), 0.0);
    }
    // The same paths, of which each knows the half of what they find; but for roundings of float.
    EXPECT_NEAR(sums[1] + sums[2], sums[0], 1e-5 * sums[0]);
    EXPECT_GT(sums[1], 0.0);
}

// Where ghosts are searched for decides how noisy they are, and nothing else: both ways gather the same light, within
// three of their errors, which are small beside it.
TEST(PreparedScene, GhostsAreTheSameWithoutASearch) {
    PreparedScene scene(under_a_sun("[camera]\nlens = \"tessar\"\n"), PixelFilter{}, Cache());
    const auto gathered = [&](bool is_guided, std::uint32_t samples) {
        const Film film =
            render_film(scene.render({"ghosts"}, 1, false, is_guided).front(), {.first = 0, .end = samples}, 1);
        PixelEstimate sum{};
        for (int y = 0; y < film.height(); ++y) {
            for (int x = 0; x < film.width(); ++x) {
                sum.rgb = sum.rgb + film.light_estimate(x, y).rgb;
                sum.variance = sum.variance + film.light_estimate(x, y).variance;
            }
        }
        return sum;
    };
    const PixelEstimate guided = gathered(true, 1024);
    const PixelEstimate even = gathered(false, 16384);
    const double error = std::sqrt(guided.variance.x + even.variance.x);
    EXPECT_LT(error, 0.05 * guided.rgb.x);
    EXPECT_NEAR(even.rgb.x, guided.rgb.x, 3.0 * error);
}

// What the edges of the stop turn aside is missing where light goes straight, whatever model brings it there.
TEST(PreparedScene, WhatIsDiffractedIsMissingInAnyModelsImage) {
    const auto straight_fraction = [](const std::string& model, const std::string& render = {}) {
        PreparedScene scene(under_a_sun("[camera]\nlens = \"tessar\"\n" + model, render), PixelFilter{}, Cache());
        const std::vector<Render> renders = scene.render({"imaged", "diffracted"}, 1, false);
        return renders.front().film.kept_fraction;
    };
    const double exact = straight_fraction("");
    EXPECT_LT(exact, 1.0);
    // Of a circle 2/(π² x) are beyond x λN (DiffractedLight.LeavesTheRestToTheImage).
    EXPECT_NEAR(straight_fraction("", "diffracted_from_airy = 5.0\n"), 1.0 - 2.0 / (kPi * kPi * 5.0), 1e-12);
    EXPECT_EQ(straight_fraction("model = \"thin-lens\"\n"), exact);
}

// A light where the lens is would shine through glass and blades as if they were not there. One just in front of the
// first surface is seen, but no light path begins there.
TEST(PreparedScene, RefusesLightsInTheLens) {
    const auto setup_with = [](const std::string& light) {
        return under_a_sun("[camera]\nlens = \"tessar\"\n", {}, light + R"(
[[objects]]
name = "panel"
shape = "quad"
size_mm = [4, 4]
translate_mm = [0, 3, -30]
material = "black"
[[materials]]
name = "black"
kind = "diffuse"
reflectance = 0
)");
    };
    const auto complaint = [&](const std::string& light, const std::vector<std::string>& passes = {"imaged"}) {
        return complaint_about([&] {
            static_cast<void>(PreparedScene(setup_with(light), PixelFilter{}, Cache()).render(passes, 1, false, false));
        });
    };
    const std::string lamp = "[[lights]]\nkind = \"point\"\nintensity_cd = 1\nposition_mm = ";
    EXPECT_TRUE(says(complaint(lamp + "[1, 2, -20]\n"), "lights[2]: shines from inside the lens, from 20 mm"));
    EXPECT_TRUE(says(
        complaint("[[lights]]\nkind = \"sphere\"\nradius_mm = 2\nluminance_cd_m2 = 1\nposition_mm = [0, 0, -90]\n"),
        "inside the lens"));
    EXPECT_TRUE(
        says(complaint("[[lights]]\nkind = \"area\"\nobject = \"panel\"\nluminance_cd_m2 = 1\n"), "inside the lens"));
    // Beside the lens, in front of it, and a dome about it.
    EXPECT_EQ(complaint(lamp + "[60, 0, -20]\n", {"imaged", "ghosts"}), "");
    EXPECT_EQ(complaint(lamp + "[0, 0, 40]\n", {"imaged", "ghosts"}), "");
    EXPECT_EQ(
        complaint("[[lights]]\nkind = \"sphere\"\nradius_mm = 500\nluminance_cd_m2 = 1\nposition_mm = [0, 0, -90]\n"),
        "");
    EXPECT_EQ(complaint(lamp + "[0, 0, 5]\n"), "");
    EXPECT_TRUE(says(complaint(lamp + "[0, 0, 5]\n", {"imaged", "ghosts"}), "5 mm in front of the lens"));
    const PreparedScene near(setup_with(lamp + "[0, 0, 5]\n"), PixelFilter{}, Cache());
    EXPECT_TRUE(says(complaint_about([&] { static_cast<void>(near.audit(1, 16)); }), "5 mm in front of the lens"));
}

/// A wall before the Tessar.
SceneSetup wall(const std::string& model) {
    return parse_scene_setup(R"([camera]
lens = "tessar"
f_number = 5.6
focus_distance_mm = 1000
position_mm = [0, 0, 0]
look_at_mm = [0, 0, 1]
sensor_mm = [36, 24]
pixels = [48, 32]
shutter_s = 0.01
iso = 100
response = "luminance"
model = ")" + model + R"("
[render]
layers = 4
[[lights]]
kind = "sun"
direction = [-0.3, 0.6, -1.0]
illuminance_lx = 1e5
[[materials]]
name = "grey"
kind = "diffuse"
reflectance = 0.5
[[objects]]
name = "wall"
shape = "polygon"
vertices_mm = [[-200, -100, 1000], [-200, 100, 1000], [200, 150, 1000], [200, -100, 1000]]
material = "grey"
)",
                             "wall.toml");
}

struct Heard {
    std::vector<std::string> refusals;
    std::vector<std::string> failures;
};

/// Its picture, with a device's help or without.
std::vector<float> pictured(const SceneSetup& setup, const PixelFilter& filter,
                            const std::optional<device::Device>& device, Heard& heard) {
    std::shared_ptr<device::SharedDevice> shared;
    if (device) {
        shared = std::make_shared<device::SharedDevice>(
            *device, [&](const std::string& why) { heard.refusals.push_back(why); },
            [&](const std::string& why) { heard.failures.push_back(why); });
    }
    const PreparedScene scene(setup, filter, Cache(), {}, {}, std::move(shared));
    return film_rgb(render_film(scene.render(1, false), {.first = 0, .end = 16}, 2)).pixels;
}

TEST(PreparedScene, IsTheSamePictureOnADevice) {
    for (const char* model : {"exact", "exact-double", "exact-float"}) {
        Heard heard;
        const std::vector<float> expected = pictured(wall(model), {}, {}, heard);
        EXPECT_GT(std::ranges::count_if(expected, [](float light) { return light > 0.0F; }), 200);
        for (const device::Device& device : every_device()) {
            EXPECT_EQ(pictured(wall(model), {}, device, heard), expected) << model << ", " << device.name();
        }
        EXPECT_TRUE(heard.refusals.empty());
        EXPECT_TRUE(heard.failures.empty());
    }
}

// While pupils are found, as the lens goes there, in the midst of the render: the picture is the same, and it is told
// once that there is no device for it, or that it failed.
TEST(PreparedScene, IsTheSamePictureWhereADeviceFails) {
    Heard none;
    const std::vector<float> expected = pictured(wall("exact"), {}, {}, none);
    bool has_failed = true;
    for (int calls = 0; has_failed; calls += 1 + calls / 4) {
        Heard heard;
        EXPECT_EQ(pictured(wall("exact"), {}, device::Device::stand_in(calls), heard), expected) << calls;
        has_failed = !heard.failures.empty() || !heard.refusals.empty();
        EXPECT_LE(heard.failures.size() + heard.refusals.size(), 1U) << calls;
        ASSERT_LT(calls, 1000000);
    }
}

// A device is told of once where it cannot help, and the picture comes anyway.
TEST(PreparedScene, SaysWhereADeviceCannotHelp) {
    Heard heard;
    const auto refusal = [&](const SceneSetup& setup, const PixelFilter& filter) {
        heard.refusals.clear();
        Heard silent;
        const std::vector<float> expected = pictured(setup, filter, {}, silent);
        EXPECT_EQ(pictured(setup, filter, device::Device::stand_in(), heard), expected);
        return heard.refusals.size() == 1 ? heard.refusals.front() : fmt::format("{} refusals", heard.refusals.size());
    };
    EXPECT_TRUE(says(refusal(wall("thin-lens"), {}), "thin-lens"));
    EXPECT_TRUE(says(refusal(wall("exact"), PixelFilter::named("gaussian")), "gaussian"));
}

}  // namespace
}  // namespace lensproof::render::prepared_scene_test
