// tests/experiments/studies/tradeoff/smooth_light_test.cpp — what smoothing takes from light, by noisy films of it.
#include "experiments/studies/tradeoff/smooth_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <random>

#include "experiments/studies/tradeoff/picture_error.h"
#include "tests/experiments/studies/tradeoff/wall_scene.h"

namespace lensproof::studies::smooth_light_test {

constexpr int kWidth = 300;
constexpr int kHeight = 200;
constexpr Vec3d kMean{2.0, 2.0, 2.0};

using LightAt = std::function<double(int x, int y)>;

/// Grey, with Gaussian noise of that deviation a pixel and channel.
formats::Image film_of(const LightAt& light, double noise, unsigned seed) {
    std::mt19937 numbers(seed);
    std::normal_distribution<double> normal(0.0, noise);
    formats::Image film = formats::make_image(kWidth, kHeight, {"R", "G", "B"});
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            for (int c = 0; c < 3; ++c) {
                film.at(x, y, c) = static_cast<float>(light(x, y) + (noise > 0.0 ? normal(numbers) : 0.0));
            }
        }
    }
    return film;
}

Measured lost(const LightAt& light, double noise, double sigma_px, double coarser = 1.0) {
    return SmoothLight({film_of(light, noise, 1), film_of(light, noise, 2)}, kMean, coarser).lost(sigma_px);
}

/// By doing it, over the mean.
double truly_lost(const LightAt& light, double sigma_px) {
    const formats::Image film = film_of(light, 0.0, 1);
    cv::Mat plane(kHeight, kWidth, CV_64F);
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            plane.at<double>(y, x) = film.at(x, y, 0) / kMean.x;
        }
    }
    cv::Mat blurred;
    cv::GaussianBlur(plane, blurred, {}, sigma_px, sigma_px, cv::BORDER_REFLECT);
    return std::sqrt(cv::mean((plane - blurred).mul(plane - blurred))[0]);
}

double edge(int x, int /*y*/) {
    return x < kWidth / 2 ? 1.0 : 1.5;
}
double slope(int x, int y) {
    return 1.0 + 0.3 * std::sin(0.02 * x) * std::cos(0.02 * y);
}
double point(int x, int y) {
    return x == 100 && y == 100 ? 1000.0 : 1.0;
}

// Closed form: 0.2337 sigma of the edge's length, over the frame. An edge in pixels is no step: 2.4 % at 2 px.
TEST(SmoothLight, LosesOfAnEdgeWhatTheClosedFormSays) {
    for (const double sigma : {2.0, 4.0, 8.0}) {
        const double wanted = 0.5 / kMean.x * std::sqrt(0.2337 * sigma / kWidth);
        EXPECT_NEAR(lost(edge, 0.0, sigma).value, wanted, 0.03 * wanted) << sigma;
        EXPECT_NEAR(truly_lost(edge, sigma), wanted, 0.03 * wanted) << sigma;
    }
    // In films of half the pixels across half the width is the same.
    EXPECT_DOUBLE_EQ(lost(edge, 0.0, 8.0, 2.0).value, lost(edge, 0.0, 4.0).value);
}

// However noisy the films, what is said holds what is lost, by two standard errors, of light of any kind; and says
// little where little is lost, although each film's noise is a hundred times that.
TEST(SmoothLight, IsHeldByItsErrorsWhateverTheNoise) {
    for (const LightAt& light : {LightAt(edge), LightAt(slope), LightAt(point)}) {
        for (const double noise : {0.0, 1.0}) {
            for (const double sigma : {2.0, 4.0, 8.0}) {
                const Measured found = lost(light, noise, sigma);
                EXPECT_GE(found.value + 2.0 * found.standard_error, 0.98 * truly_lost(light, sigma))
                    << light(100, 100) << " " << noise << " " << sigma;
            }
        }
    }
    const Measured found = lost(slope, 1.0, 4.0);
    EXPECT_LT(found.value + 2.0 * found.standard_error, 0.02);
}

// As a few samples of the pilot's pixels find them, and surer.
TEST(SmoothLight, OfAPassHasThePassesLight) {
    const Pilot pilot(wall("tessar", 4.5, 20.0), {});
    const Measured many = pass_films(pilot, "ghosts", 0, {.first = 0, .end = 6}).fraction(pilot);
    const Measured few_ev =
        picture_errors(pilot.with_pass("ghosts").rgb, pilot.full().rgb, pilot.settings().probe.threads).exposure_ev;
    const double gain = std::exp2(few_ev.value);
    const double few_error = std::log(2.0) * gain * few_ev.standard_error;
    EXPECT_GT(many.value, 10.0 * many.standard_error);
    EXPECT_LT(many.standard_error, few_error);
    EXPECT_NEAR(many.value, gain - 1.0, 4.0 * std::hypot(many.standard_error, few_error));
}

// Films that were added to are those of all their samples at once, but for the rounding of floats.
TEST(SmoothLight, KeptFilmsGrow) {
    const Pilot pilot(wall("tessar", 4.5, 20.0), {.smooth_pixels = 600});
    KeptFilms films(pilot);
    EXPECT_EQ(films.of("ghosts", 2).samples, 2);
    const PassFilms& grown = films.of("ghosts", 6);
    EXPECT_EQ(&films.of("ghosts", 2), &grown);
    const PassFilms whole = pass_films(pilot, "ghosts", 0, {.first = 0, .end = 6});
    ASSERT_EQ(grown.samples, whole.samples);
    for (std::size_t i = 0; i < whole.rgb[0].pixels.size(); ++i) {
        ASSERT_NEAR(grown.rgb[0].pixels[i], whole.rgb[0].pixels[i], 1e-5F * std::abs(whole.rgb[0].pixels[i])) << i;
    }
}

}  // namespace lensproof::studies::smooth_light_test
