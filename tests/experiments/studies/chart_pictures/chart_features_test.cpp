// tests/experiments/studies/chart_pictures/chart_features_test.cpp — what is measured of a chart's features in a
// picture: painted ones, whose moments are known, and rendered ones, beside the lens's rays.
#include "experiments/studies/chart_pictures/chart_features.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/render/film/film_image.h"
#include "engine/render/prepared_scene.h"
#include "engine/render/progressive.h"
#include "experiments/studies/chart_pictures/film_rays.h"
#include "experiments/studies/chart_pictures/seen_light.h"
#include "tests/complaint.h"

namespace lensproof::studies::chart_features_test {

constexpr render::Sensor kSensor{.width = 120, .height = 80, .pixel_pitch_mm = 0.3};

/// A slanting white with a Gaussian shadow, wider along x, of depth 1 and 2 in red and blue as in green.
formats::Image shadow(Vec2d middle, Vec2d widths) {
    formats::Image image = formats::make_image(kSensor.width, kSensor.height, {"R", "G", "B"});
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const Vec2d at = kSensor.position(x, y);
            const Vec2d off = at - middle;
            const double depth =
                std::exp(-0.5 * (off.x * off.x / (widths.x * widths.x) + off.y * off.y / (widths.y * widths.y)));
            for (int c = 0; c < 3; ++c) {
                image.at(x, y, c) = static_cast<float>((c + 1) * (5.0 + 0.1 * at.x - 0.2 * at.y - depth));
            }
        }
    }
    return image;
}

// What is left of a Gaussian beyond 5 widths is 6e-7 of it; floats of 5 are good to 3e-7, over 700 pixels.
TEST(SeenLight, IsWhatTheFeatureTakesFromThePlaneAboutIt) {
    const Vec2d middle{4.1, -2.3};
    const Vec2d widths{0.9, 0.6};
    const SeenLight seen = seen_light(shadow(middle, widths), kSensor, {4.0, -2.4}, 8.0, [](Vec2d off) {
        const double r = std::hypot(off.x, off.y);
        return r < 5.0 ? Zone::feature : r < 7.0 ? Zone::border : Zone::beyond;
    });
    ASSERT_TRUE(seen.is_in_frame);
    EXPECT_NEAR(seen.about.y, 2.0 * (5.0 + 0.1 * 4.0 + 0.2 * 2.4), 1e-4);
    for (double Vec3d::*colour : {&Vec3d::x, &Vec3d::y, &Vec3d::z}) {
        const LightMoments moments = light_moments(seen.light, colour);
        EXPECT_NEAR(moments.centroid.x, middle.x, 1e-3);
        EXPECT_NEAR(moments.centroid.y, middle.y, 1e-3);
        EXPECT_NEAR(moments.rms.x, widths.x, 2e-3);
        EXPECT_NEAR(moments.rms.y, widths.y, 2e-3);
        EXPECT_NEAR(moments.asymmetry, 0.0, 5e-3);
    }
    const auto all = [](Vec2d) { return Zone::border; };
    EXPECT_FALSE(seen_light(shadow(middle, widths), kSensor, {17.0, 0.0}, 8.0, all).is_in_frame);
}

// Two thirds of the light at −1, one at 2: the mean is 0, the second moment 2, the third 2.
TEST(LightMoments, TellWhichWayLightTrails) {
    const LightMoments moments =
        light_moments({{{-1.0, 0.0}, {0.0, 2.0, 0.0}}, {{2.0, 0.0}, {0.0, 1.0, 0.0}}}, &Vec3d::y);
    EXPECT_DOUBLE_EQ(moments.light, 3.0);
    EXPECT_DOUBLE_EQ(moments.centroid.x, 0.0);
    EXPECT_DOUBLE_EQ(moments.rms.x, std::sqrt(2.0));
    EXPECT_DOUBLE_EQ(moments.asymmetry, 1.0);
}

render::SceneSetup setup_of(const std::string& lens, const std::string& chart, double focus_mm) {
    return render::parse_scene_setup(fmt::format(R"([camera]
lens = "{}"
f_number = 2.0
focus_distance_mm = {}
sensor_mm = [36.0, 24.0]
pixels = [240, 160]
shutter_s = 0.1
iso = 100.0
response = "cie-1931"

[light]
illuminant = "D65"
luminance_cd_m2 = 1000.0

[chart]
{}

[pose]
distance_mm = 2000.0

[render]
samples_per_pixel = 32
layers = 16
strata_per_layer = 1
)",
                                                 lens, focus_mm, chart),
                                     "scene.toml");
}

constexpr const char* kDots =
    "kind = \"point-grid\"\npoints = [5, 5]\npitch_mm = 240.0\ndot_mm = 30.0\nblack_reflectance = 0.0";

struct Difference {
    double mean = 0.0;
    double standard_error = 0.0;
};

Difference difference(const std::vector<ChartFeature>& features, double FeatureLook::*value) {
    const auto n = static_cast<double>(features.size());
    Difference found;
    for (const ChartFeature& feature : features) {
        found.mean += (feature.picture.*value - feature.rays.*value) / n;
    }
    double square = 0.0;
    for (const ChartFeature& feature : features) {
        const double off = feature.picture.*value - feature.rays.*value - found.mean;
        square += off * off;
    }
    found.standard_error = std::sqrt(square / (n * (n - 1.0)));
    return found;
}

// Within four standard errors of the features' mean; and these are small enough to tell a lens that is focused
// 0.2 m nearer.
TEST(ChartFeatures, OfARenderAreThoseOfTheRays) {
    const render::SceneSetup setup = setup_of("xenon", kDots, 1000.0);
    render::PreparedScene scene(setup, render::PixelFilter{}, Cache{});
    const formats::Image picture =
        render::film_rgb(render::render_film(scene.render(1, false), {.first = 0, .end = 32}, 0, [](double) {}));
    const std::vector<ChartFeature> features = chart_features(setup, scene.camera(), {}, picture, 0);
    ASSERT_GT(features.size(), 12U);
    EXPECT_TRUE(std::ranges::is_sorted(features, {}, &ChartFeature::field_deg));
    for (double FeatureLook::*value : {&FeatureLook::radius_um, &FeatureLook::tangential_um, &FeatureLook::sagittal_um,
                                       &FeatureLook::red_um, &FeatureLook::blue_um}) {
        const Difference off = difference(features, value);
        EXPECT_LT(std::abs(off.mean), 4.0 * off.standard_error) << off.mean;
        EXPECT_LT(off.standard_error, 10.0);
    }
    const render::PreparedScene other(setup_of("xenon", kDots, 800.0), render::PixelFilter{}, Cache{});
    const Difference off = difference(chart_features(setup, other.camera(), {}, picture, 0), &FeatureLook::sagittal_um);
    EXPECT_LT(off.mean, -20.0 * off.standard_error);
}

// Nine bands stand for all wavelengths.
TEST(ChartFeatures, MoreBandsMoveNoCentroidByAFifthOfAMicrometre) {
    const render::PreparedScene scene(setup_of("biotar", kDots, 1800.0), render::PixelFilter{}, Cache{});
    const Vec3d corner{560.0, 420.0, -2000.0};
    const auto centroid = [&](int bands, double Vec3d::*colour) {
        std::vector<FilmLight> light;
        FilmRays(scene.camera(), bands).add(corner, 1.0, light);
        return light_moments(light, colour).centroid;
    };
    for (double Vec3d::*colour : {&Vec3d::x, &Vec3d::y, &Vec3d::z}) {
        const Vec2d off = centroid(27, colour) - centroid(kBandsOfFilmRays, colour);
        EXPECT_LT(std::hypot(off.x, off.y), 2e-4);
    }
}

TEST(ChartFeatures, SayWhatTheyCannotMeasure) {
    const auto complaint = [](const std::string& lens, const std::string& chart, const ChartChoice& choice) {
        const render::SceneSetup setup = setup_of(lens, chart, 1800.0);
        const render::PreparedScene scene(setup, render::PixelFilter{}, Cache{});
        const formats::Image picture = formats::make_image(240, 160, {"R", "G", "B"});
        return complaint_about([&] { chart_features(setup, scene.camera(), choice, picture, 1); });
    };
    EXPECT_TRUE(says(complaint("xenon", "kind = \"checkerboard\"\nsquares = [9, 7]\nsquare_mm = 100.0", {}),
                     "of discs, dots or crosses"));
    EXPECT_TRUE(says(complaint("xenon", kDots, {.objects = {"wall"}}), "no chart \"wall\""));
    EXPECT_TRUE(says(complaint("xenon", "kind = \"point-grid\"\npoints = [2, 2]\npitch_mm = 3000.0\ndot_mm = 30.0", {}),
                     "no feature of the chart lies in the frame"));
}

}  // namespace lensproof::studies::chart_features_test
