// What films make of real camera paths: stated errors against the spread of independent renders, filters, features.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/validation/rendered_scene.h"

namespace lensproof::film_render_test {

constexpr int kWidth = 24;
constexpr int kHeight = 18;

render::Camera tessar_camera(const std::string& filter = "box") {
    const render::CameraSettings settings{.lens = "tessar",
                                          .f_number = 4.0,
                                          .focus_distance_mm = 10000.0,
                                          .sensor = {.width = kWidth, .height = kHeight, .pixel_pitch_mm = 1.5},
                                          .exposure = {.time_s = 0.05, .iso = 100.0},
                                          .response = "cie-1931"};
    return {settings, {}, render::PixelFilter::named(filter), {}};
}

const scene::Chart kFlat{.pattern = scene::FlatField{}};
const scene::Chart kBoard{.pattern = scene::Checkerboard{8, 6, 500.0}};
constexpr scene::Placement kFacing{.distance_mm = 10000.0};

/// Mean over pixels and R, G, B of the stated variance.
double stated_variance(const render::Film& film) {
    double sum = 0.0;
    for (int i = 0; i < kWidth * kHeight; ++i) {
        const Vec3d variance = film.estimate(i % kWidth, i / kWidth).variance;
        sum += (variance.x + variance.y + variance.z) / (3 * kWidth * kHeight);
    }
    return sum;
}

/// The same, as it shows in renders of other seeds.
double spread_of(const std::vector<render::Film>& films) {
    const auto n = static_cast<double>(films.size());
    double sum = 0.0;
    for (int i = 0; i < kWidth * kHeight; ++i) {
        Vec3d mean;
        for (const render::Film& film : films) {
            mean = mean + (1.0 / n) * film.estimate(i % kWidth, i / kWidth).rgb;
        }
        for (const render::Film& film : films) {
            const Vec3d off = film.estimate(i % kWidth, i / kWidth).rgb - mean;
            sum += dot(off, off) / ((n - 1.0) * 3 * kWidth * kHeight);
        }
    }
    return sum;
}

// The stated variance is an upper bound of that of independent renders, and of their order: samples of several blocks
// lie between each other's, which is worth a factor of 2 to 8 in variance here (128 samples; more samples, more). 8
// renders of 432 pixels and 3 channels scatter by 2 % in spread.
TEST(FilmRender, StatedErrorsBoundTheSpreadOfSeeds) {
    const render::Camera camera = tessar_camera();
    for (const scene::Chart& chart : {kFlat, kBoard}) {
        std::vector<render::Film> films;
        double stated = 0.0;
        for (std::uint64_t seed = 0; seed < 8; ++seed) {
            films.push_back(rendered({camera, chart, kFacing}, {0, 128}, seed));
            stated += stated_variance(films.back()) / 8.0;
        }
        const double spread = spread_of(films);
        EXPECT_GT(stated, spread) << scene::kind_name(chart);
        EXPECT_LT(stated, 10.0 * spread) << scene::kind_name(chart);
    }
}

// Three shards of whole blocks, merged, are the whole render: its values and its variances to rounding.
TEST(FilmRender, ShardsAddUpWithTheirVariance) {
    const render::Camera camera = tessar_camera();
    const SeenChart seen{camera, kBoard, kFacing};
    const render::Film whole = rendered(seen, {0, 220}, 1);
    render::Film sum = rendered(seen, {144, 220}, 1);
    sum.merge(rendered(seen, {0, 64}, 1));
    sum.merge(rendered(seen, {64, 144}, 1));
    for (int i = 0; i < kWidth * kHeight; ++i) {
        const auto [rgb, variance] = sum.estimate(i % kWidth, i / kWidth);
        const render::PixelEstimate expected = whole.estimate(i % kWidth, i / kWidth);
        EXPECT_NEAR(rgb.y, expected.rgb.y, 1e-12 * expected.rgb.y);
        EXPECT_NEAR(variance.y, expected.variance.y, 1e-9 * expected.variance.y);
        EXPECT_EQ(sum.counts(i % kWidth, i / kWidth).samples, 220U);
    }
}

// Every filter has integral 1, so that a flat field, whose light falls off by a few per cent towards the corners, stays
// what it is: means over the picture within four standard errors, stated ones.
TEST(FilmRender, FiltersKeepTheLight) {
    const auto mean_green = [](const render::Film& film) {
        double sum = 0.0;
        double variance = 0.0;
        for (int i = 0; i < kWidth * kHeight; ++i) {
            sum += film.estimate(i % kWidth, i / kWidth).rgb.y / (kWidth * kHeight);
            variance += film.estimate(i % kWidth, i / kWidth).variance.y / std::pow(kWidth * kHeight, 2);
        }
        return std::pair(sum, variance);
    };
    const render::Camera box_camera = tessar_camera();
    const auto [box, box_variance] = mean_green(rendered({box_camera, kFlat, kFacing}, {0, 128}, 1));
    for (const std::string& name : render::PixelFilter::known_names()) {
        const render::Camera camera = tessar_camera(name);
        const auto [mean, variance] = mean_green(rendered({camera, kFlat, kFacing}, {0, 128}, 2));
        EXPECT_NEAR(mean, box, 4.0 * std::sqrt(variance + box_variance)) << name;
        EXPECT_LT(std::sqrt(variance), 0.01 * mean) << name << ": sharp enough to show a loss";
    }
}

// A board that faces the camera is everywhere as deep as it is far, its normal looks back along the axis, and its
// albedo is that of its squares. A tilted one's normal is tilted.
TEST(FilmRender, FeaturesAreThoseOfTheChart) {
    const render::Camera camera = tessar_camera();
    const render::Film film = rendered({camera, kBoard, kFacing, true}, {0, 16}, 1);
    for (int i = 0; i < kWidth * kHeight; ++i) {
        const render::PixelFeatures features = film.features(i % kWidth, i / kWidth);
        EXPECT_NEAR(features.depth_mm, 10000.0, 1e-6);
        EXPECT_NEAR(features.normal.z, -film.coverage(i % kWidth, i / kWidth), 1e-12);
        EXPECT_GE(features.albedo_rgb.y, 0.04 * film.coverage(i % kWidth, i / kWidth) - 1e-12);
        EXPECT_LE(features.albedo_rgb.y, 0.9 + 1e-12);
    }
    EXPECT_GT(film.coverage(kWidth / 2, kHeight / 2), 0.95) << "a path that the lens stops meets nothing";
    const SeenChart tilted{camera, kBoard, {.distance_mm = 10000.0, .tilt_deg = {0.0, 60.0, 0.0}}, true};
    const render::PixelFeatures features = rendered(tilted, {0, 16}, 1).features(kWidth / 2, kHeight / 2);
    EXPECT_NEAR(std::abs(features.normal.z / features.normal.x), 1.0 / std::tan(std::acos(-1.0) / 3.0), 1e-12);
}

}  // namespace lensproof::film_render_test
