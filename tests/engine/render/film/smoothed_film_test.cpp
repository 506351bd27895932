#include "engine/render/film/smoothed_film.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/engine/render/film/film_sample.h"

namespace lensproof::render::smoothed_film_test {

constexpr int kSide = 41;
constexpr int kMiddle = kSide / 2;
constexpr double kSigma = 2.0;
constexpr TileSamples kAll{.rect = {0, 0, kSide, kSide}, .first = 0, .end = 1};

/// The Gaussian's density at a distance, 1/px².
double gaussian(double x, double y) {
    return std::exp(-(x * x + y * y) / (2.0 * kSigma * kSigma)) / (2.0 * std::numbers::pi * kSigma * kSigma);
}

// A point becomes the Gaussian, in colours and layers alike, whatever paths brought it, and keeps its light. Cut off at
// four sigma along each axis it lacks 1.3e-4 of its light, by which the rest is more: 5e-6 of what stands at its peak.
TEST(SmoothedFilm, SpreadsAPointAsAGaussian) {
    FilmLayout layout = plain_film(kSide, kSide, 4);
    layout.has_splats = true;
    constexpr std::array<std::uint16_t, 4> kStrata = {0, 1, 2, 3};
    const Film film = film_of(layout, kAll, [&](FilmTile& tile) {
        tile.add(tile.pixel(kMiddle, kMiddle), 0, kStrata, std::array{1.0F, 1.0F, 1.0F, 1.0F});
        tile.begin_light_path();
        tile.splat(all_at(kMiddle, kMiddle), kStrata, std::array{2.0F, 2.0F, 2.0F, 2.0F});
    });
    const Film spread = smoothed(film, kSigma, 1);
    double light = 0.0;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const double wanted = gaussian(x - kMiddle, y - kMiddle);
            EXPECT_NEAR(spread.camera_estimate(x, y).rgb.x, wanted, 6e-6) << x << " " << y;
            EXPECT_NEAR(spread.light_estimate(x, y).rgb.y, 2.0 * 2.0 * wanted, 4.0 * 6e-6) << x << " " << y;
            std::array<double, 4> layers{};
            spread.layers(x, y, layers);
            EXPECT_NEAR(layers[3], 3.0 * wanted, 3.0 * 6e-6) << x << " " << y;
            light += spread.estimate(x, y).rgb.x;
        }
    }
    EXPECT_NEAR(light, 3.0, 1e-12);  // all of it lies within the frame
    EXPECT_EQ(spread.light_paths(), film.light_paths());
}

// An even field stays even up to the frame's corners. Its pixels' variance falls to the sum of the weights' squares, in
// a corner over what of the weights is within, squared. A pixel's own variance is an estimate, by 16 blocks with a
// relative error of 0.37 (√(2/15), a little more of exponential samples); the smoothed one is a mean over half as many
// pixels as the light is, a quarter of these in a corner: three errors each.
TEST(SmoothedFilm, LeavesEvenLightEvenAndLessNoisy) {
    constexpr std::uint32_t kSamples = 16 * kSamplesPerBlock;
    const Film film = exponential_film(kSide, 1, 0, kSamples);
    const Film spread = smoothed(film, kSigma, 1);
    const double gain = smoothing_gain(kSigma);
    const double middle = 1.0 / kSamples / gain;
    const double own = gaussian(0.0, 0.0);  // weight of a pixel, of both axes
    const double corner =
        middle * std::pow((1.0 + std::sqrt(own * own * gain)) / 2.0, 2) / std::pow((1.0 + std::sqrt(own)) / 2.0, 4);
    constexpr double kOfPixel = 0.37;
    EXPECT_NEAR(spread.estimate(kMiddle, kMiddle).variance.x, middle, 3.0 * kOfPixel * std::sqrt(2.0 / gain) * middle);
    EXPECT_NEAR(spread.estimate(0, 0).variance.x, corner, 3.0 * kOfPixel * std::sqrt(8.0 / gain) * corner);
    double squares = 0.0;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const PixelEstimate estimate = spread.estimate(x, y);
            EXPECT_NEAR(estimate.rgb.x, 1.0, 5.0 * std::sqrt(estimate.variance.x)) << x << " " << y;
            squares += std::pow(estimate.rgb.x - 1.0, 2) / estimate.variance.x;
        }
    }
    // A film's worth of independent pixels is 1681 over the gain, 33: their mean square is 1 within three of √(2/33).
    EXPECT_NEAR(squares / (kSide * kSide), 1.0, 3.0 * std::sqrt(2.0 * gain / (kSide * kSide)));
}

}  // namespace lensproof::render::smoothed_film_test
