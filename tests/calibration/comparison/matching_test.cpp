// tests/calibration/comparison/matching_test.cpp — exposure, radial curves and noise, of pictures that differ by what
// is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/comparison/denoised_difference.h"
#include "calibration/comparison/exposure_match.h"
#include "calibration/comparison/picture_comparison.h"
#include "calibration/comparison/radial_difference.h"
#include "tests/calibration/comparison/pictures.h"

namespace lensproof::calibration::matching_test {
namespace {

using comparison_test::discs;
using comparison_test::kHere;

constexpr int kSide = 128;
constexpr ClippedFrom kNeverClipped{.a = std::numeric_limits<double>::infinity(),
                                    .b = std::numeric_limits<double>::infinity()};

TEST(ExposureMatch, FindsAGainAChannelUnderNoise) {
    const formats::Image a = discs(kSide, kSide, kHere, 0.02, 1);
    formats::Image b = discs(kSide, kSide, kHere, 0.02, 2);
    const std::array<double, 3> gains{1.25, 0.9, 1.0};
    for (std::size_t i = 0; i < b.pixels.size(); ++i) {
        b.pixels[i] = static_cast<float>(b.pixels[i] / gains[i % 3]);
    }
    const ExposureMatch match = match_exposure(a, b, whole_frame(a), kNeverClipped);
    ASSERT_TRUE(match.is_matched);
    for (std::size_t c = 0; c < 3; ++c) {
        // Noise of 0.02 in both, of a mean of 0.08 or more over 128² px: 0.02 sqrt(2) / (0.08 · 128) = 0.28 %; the
        // jackknife knows that to 9 %.
        EXPECT_NEAR(match.gains[c].value, gains[c], 4.0 * match.gains[c].standard_error);
        EXPECT_LT(match.gains[c].standard_error, 0.004);
    }
}

TEST(ExposureMatch, LeavesWhatDiffersByChance) {
    const formats::Image a = discs(kSide, kSide, kHere, 0.02, 1);
    EXPECT_FALSE(match_exposure(a, discs(kSide, kSide, kHere, 0.02, 2), whole_frame(a), kNeverClipped).is_matched);
    const formats::Image black = formats::make_image(kSide, kSide, {"R", "G", "B"});
    EXPECT_FALSE(match_exposure(a, black, whole_frame(a), kNeverClipped).is_matched);
}

TEST(ExposureMatch, DoesNotAskClippedPixels) {
    const formats::Image a = discs(kSide, kSide, kHere);
    formats::Image b = a;
    for (float& value : b.pixels) {
        value = std::min(2.0F * value, 0.5F);
    }
    const ExposureMatch match = match_exposure(a, b, whole_frame(a), {.a = 1.0, .b = 0.5});
    for (const Estimate& gain : match.gains) {
        EXPECT_NEAR(gain.value, 0.5, 1e-6);
    }
}

// A falloff of 2^(−r²) in green and half of that, in EV, in red and blue.
TEST(RadialDifferences, AreTheFalloffThatWasPutIn) {
    const formats::Image a = comparison_test::made(kSide, kSide, [](int, int, int) { return 0.5; });
    const formats::Image b = comparison_test::made(kSide, kSide, [](int x, int y, int c) {
        const double r = std::hypot(x - 0.5 * (kSide - 1), y - 0.5 * (kSide - 1)) / (0.5 * std::sqrt(2.0) * kSide);
        return 0.5 * std::exp2(-r * r * (c == 1 ? 1.0 : 0.5));
    });
    const auto curves = radial_differences(a, b, formats::make_image(kSide, kSide, {"none"}), whole_frame(a));
    const Curve& red = curves.at("red_over_green_ev");
    ASSERT_EQ(red.image_height.size(), 20U);
    for (std::size_t i = 0; i < red.image_height.size(); ++i) {
        const double r = red.image_height[i];
        // A ring is 1/20 wide: the middle's value within half of the change across it, r/20, and of the rings near the
        // corners only the corners.
        EXPECT_NEAR(red.value[i], 0.5 * r * r, 0.5 * r / 20.0 + 2e-3) << r;
        EXPECT_LE(red.lower_95[i], red.value[i]);
        const double brightness = curves.at("brightness_ev").value[i];
        EXPECT_NEAR(brightness, -r * r * (0.7152 + 0.5 * 0.2848), r / 20.0 + 0.02 * r * r) << r;
    }
}

// Pure noise leaves nothing but chance: beyond two standard deviations 5 in 100. A square that is brighter by one
// standard deviation of a pixel's noise, five of its window's, stays.
TEST(DenoisedDifference, KeepsWhatIsMoreThanNoise) {
    const formats::Image a = discs(kSide, kSide, kHere, 0.03, 1);
    formats::Image b = discs(kSide, kSide, kHere, 0.03, 2);
    const double sigma = 0.03 * std::sqrt(2.0) * std::sqrt(0.2126 * 0.2126 + 0.7152 * 0.7152 + 0.0722 * 0.0722);
    const DenoisedDifference noise = denoised_difference(a, b, whole_frame(a));
    EXPECT_NEAR(noise.noise, sigma, 0.1 * sigma);
    EXPECT_NEAR(noise.noise_fraction, 0.9545, 0.02);
    for (int y = 40; y < 80; ++y) {
        for (int x = 40; x < 80; ++x) {
            for (int c = 0; c < 3; ++c) {
                b.at(x, y, c) += static_cast<float>(sigma);
            }
        }
    }
    const DenoisedDifference square = denoised_difference(a, b, whole_frame(a));
    int seen = 0;
    for (int y = 46; y < 74; ++y) {
        for (int x = 46; x < 74; ++x) {
            seen += square.map.at(x, y, 0) > 0.25 * sigma ? 1 : 0;
        }
    }
    EXPECT_GT(seen, 0.98 * 28 * 28);
}

// Moved, darker and of another white: once both are matched, what is left is noise of 1 % in both. PSNR of the linear
// values would be −20 lg(0.01 √2); the displayed ones are steeper in the dark.
TEST(ComparePictures, BringsOneToTheOther) {
    const formats::Image a = discs(kSide, kSide, kHere, 0.003, 1);
    formats::Image b = discs(
        kSide, kSide,
        [](const Vec2d& p) {
            return p - Vec2d{2.4, 1.7};
        },
        0.003, 2);
    for (std::size_t i = 0; i < b.pixels.size(); ++i) {
        b.pixels[i] *= i % 3 == 0 ? 0.7F : 0.8F;
    }
    const PictureComparison as_they_are =
        compare_pictures(a, b, {.registers = false, .matches_exposure = false, .clipped = kNeverClipped, .threads = 1});
    const PictureComparison matched = compare_pictures(a, b, {.clipped = kNeverClipped, .threads = 1});
    EXPECT_EQ(matched.registration.model, WarpModel::translation);
    EXPECT_TRUE(matched.exposure.is_matched);
    EXPECT_NEAR(matched.exposure.gains[0].value, 1.0 / 0.7, 0.005);
    EXPECT_GT(matched.psnr_db.value, as_they_are.psnr_db.value + 10.0);
    EXPECT_GT(matched.ssim.value, as_they_are.ssim.value);
    EXPECT_LT(matched.flip.value, 0.3 * as_they_are.flip.value);
    EXPECT_LT(matched.ciede2000_mean.value, 0.5 * as_they_are.ciede2000_mean.value);
    EXPECT_GE(matched.ciede2000_p99.value, matched.ciede2000_mean.value);
    for (const double value : matched.curves.at("brightness_ev").value) {
        EXPECT_NEAR(value, 0.0, 0.05);  // rings of 60 px and more: 0.003 sqrt(2) / 0.05 / sqrt(60) is 0.016 EV
    }
}

}  // namespace
}  // namespace lensproof::calibration::matching_test
