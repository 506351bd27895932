// tests/experiments/studies/tradeoff/picture_error_test.cpp — a model's error told from its pictures' noise.
#include "experiments/studies/tradeoff/picture_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "calibration/comparison/ciede2000.h"

namespace lensproof::studies::picture_error_test {

using formats::Image;

/// A coloured gradient, brighter by `gain`, with noise of that fraction of each pixel.
Image picture(double gain, double noise, unsigned seed) {
    Image image = formats::make_image(64, 48, {"R", "G", "B"});
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const double light = gain * (0.1 + 0.4 * x / image.width + 0.1 * c * y / image.height);
                image.at(x, y, c) = static_cast<float>(light * (1.0 + noise * normal(random)));
            }
        }
    }
    return image;
}

std::vector<Image> pictures(double gain, double noise, unsigned seed) {
    std::vector<Image> all;
    for (unsigned i = 0; i < 4; ++i) {
        all.push_back(picture(gain, noise, seed + i));
    }
    return all;
}

double mean_ciede2000(const Image& a, const Image& b) {
    const Image map = calibration::ciede2000_map(a, b, 1);
    double sum = 0.0;
    for (const float value : map.pixels) {
        sum += static_cast<double>(value);
    }
    return sum / static_cast<double>(map.pixels.size());
}

// Noise adds to the square of a bias: of 3072 pixels with noise n its mean square scatters by n² √(2/3/3072), so that a
// bias of √(3 · 0.015) n = 0.2 n may be seen where there is none.
TEST(PictureError, NoiseAloneIsNoBias) {
    const PictureErrors found = picture_errors(pictures(1.0, 0.1, 1), pictures(1.0, 0.1, 101), 1);
    EXPECT_GT(found.ciede2000.noise, 1.0);
    EXPECT_LT(found.ciede2000.bias.value, 0.2 * found.ciede2000.noise);
    EXPECT_GT(found.ciede2000.bias.standard_error, 0.0);
    EXPECT_LT(found.flip.bias.value, 0.2 * found.flip.noise);
    EXPECT_NEAR(found.exposure_ev.value, 0.0, 4.0 * found.exposure_ev.standard_error);
}

// An exposure of 8 % under more noise than that comes out as without noise. Of noise n, n² scatters by n² √(2/3/3072)
// in each of two terms: with n twice the bias b by 0.08 b², that is b by 4 %; three times that, and 5 % because n is
// not normal.
TEST(PictureError, FindsABiasBelowTheNoise) {
    const double expected = mean_ciede2000(picture(1.08, 0.0, 0), picture(1.0, 0.0, 0));
    const PictureErrors found = picture_errors(pictures(1.08, 0.06, 1), pictures(1.0, 0.06, 101), 1);
    ASSERT_GT(found.ciede2000.noise, expected);
    EXPECT_NEAR(found.ciede2000.bias.value, expected, 0.17 * expected);
    EXPECT_NEAR(found.ciede2000.bias.value, expected, 4.0 * found.ciede2000.bias.standard_error);
    EXPECT_NEAR(found.exposure_ev.value, std::log2(1.08), 4.0 * found.exposure_ev.standard_error);
}

TEST(PictureError, WithoutNoiseItIsTheMetric) {
    const PictureErrors found = picture_errors(pictures(1.08, 0.0, 1), pictures(1.0, 0.0, 1), 1);
    const double expected = mean_ciede2000(picture(1.08, 0.0, 0), picture(1.0, 0.0, 0));
    EXPECT_NEAR(found.ciede2000.bias.value, expected, 1e-4 * expected);  // of floats
    EXPECT_NEAR(found.ciede2000.noise, 0.0, 1e-3);
    EXPECT_NEAR(found.exposure_ev.value, std::log2(1.08), 1e-5);
}

}  // namespace lensproof::studies::picture_error_test
