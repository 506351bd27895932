// tests/calibration/comparison/metrics_test.cpp — PSNR, SSIM and FLIP against their authors' programs.
#include <gtest/gtest.h>

#include <cmath>

#include "calibration/comparison/ciede2000.h"
#include "calibration/comparison/colour_planes.h"
#include "calibration/comparison/flip.h"
#include "calibration/comparison/noise_ratio.h"
#include "calibration/comparison/structural_similarity.h"
#include "tests/calibration/comparison/pictures.h"

namespace lensproof::calibration::metrics_test {
namespace {

using comparison_test::high_range_picture;
using comparison_test::low_range_picture;

// The numbers were printed by `python3 tests/validation/picture_metrics_test.py - FOLDER` (scikit-image 0.26.0,
// flip-evaluator 1.7), which says of the tolerances.
TEST(PictureMetrics, AreThoseOfOtherPrograms) {
    const formats::Image a = low_range_picture(false);
    const formats::Image b = low_range_picture(true);
    const Overlap all = whole_frame(a);
    const formats::Image shown_a = displayed(a, 1);
    const formats::Image shown_b = displayed(b, 1);
    EXPECT_NEAR(peak_signal_to_noise_db(rms_difference(shown_a, shown_b, all)).value, 32.585591288, 1e-4);
    EXPECT_NEAR(
        mean_over(structural_similarity(shown_a, shown_b, 1), shrunk(all, a.width, a.height, kSsimReach_px)).value,
        0.974422179, 1e-6);
    EXPECT_NEAR(mean_over(flip_low_range(a, b, kFlipPixelsPerDegree, 1), all).value, 0.03582821, 1e-5);
    EXPECT_NEAR(mean_over(ciede2000_map(a, b, 1), all).value, 3.6004735, 2e-3);
}

TEST(PictureMetrics, OfAHighRangeAreThoseOfFlipsAuthors) {
    const formats::Image a = high_range_picture(false);
    const formats::Image b = high_range_picture(true);
    const FlipExposures exposures = flip_exposures(a);
    EXPECT_NEAR(exposures.first_ev, -1.8412209, 1e-4);
    EXPECT_NEAR(exposures.last_ev, 1.4819572, 1e-4);
    EXPECT_EQ(exposures.count, 4);
    EXPECT_NEAR(mean_over(flip_high_range(a, b, kFlipPixelsPerDegree, exposures, 1), whole_frame(a)).value, 0.01626390,
                1e-5);
}

// Stripes of rows are filtered one by one; a picture that is several of them high shows no seam.
TEST(PictureMetrics, KnowNoStripes) {
    const auto tall = [](int change) {
        return comparison_test::made(12, 200, [change](int x, int y, int c) {
            return 0.5 + 0.3 * std::sin(0.3 * x + 0.2 * y + c) + (y > 100 ? 0.02 * change : 0.0);
        });
    };
    const formats::Image a = tall(0);
    const formats::Image b = tall(1);
    const auto upside_down = [](const formats::Image& image) {
        formats::Image turned = image;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                for (int c = 0; c < image.channel_count(); ++c) {
                    turned.at(x, image.height - 1 - y, c) = image.at(x, y, c);
                }
            }
        }
        return turned;
    };
    const formats::Image flip = flip_low_range(a, b, kFlipPixelsPerDegree, 1);
    const formats::Image ssim = structural_similarity(a, b, 1);
    const formats::Image turned_flip = flip_low_range(upside_down(a), upside_down(b), kFlipPixelsPerDegree, 1);
    const formats::Image turned_ssim = structural_similarity(upside_down(a), upside_down(b), 1);
    for (int y = 0; y < a.height; ++y) {
        // Single precision's sums, the other way round: FLIP is known to 1e-4 by them, since it takes a root.
        EXPECT_NEAR(flip.at(5, y, 0), turned_flip.at(5, a.height - 1 - y, 0), 1e-4) << y;
        EXPECT_NEAR(ssim.at(5, y, 0), turned_ssim.at(5, a.height - 1 - y, 0), 1e-6) << y;
    }
}

TEST(PictureMetrics, OfEqualPicturesAreTheBest) {
    const formats::Image a = low_range_picture(false);
    const Estimate rms = rms_difference(a, a, whole_frame(a));
    EXPECT_EQ(rms.value, 0.0);
    EXPECT_TRUE(std::isinf(peak_signal_to_noise_db(rms).value));
    EXPECT_EQ(mean_over(flip_low_range(a, a, kFlipPixelsPerDegree, 1), whole_frame(a)).value, 0.0);
}

// The jackknife's standard error of a mean of independent numbers is s / sqrt(n); of 64 blocks it is known to 9 %
// (1 / sqrt(2 · 63)), so 4 of those.
TEST(BlockSums, KnowTheErrorOfAMean) {
    formats::Image map = formats::make_image(256, 256, {"noise"});
    std::mt19937 chance(3);
    std::normal_distribution<float> normal(2.0F, 0.5F);
    for (float& value : map.pixels) {
        value = normal(chance);
    }
    const Estimate mean = mean_over(map, whole_frame(map));
    EXPECT_NEAR(mean.value, 2.0, 4.0 * 0.5 / 256.0);
    EXPECT_NEAR(mean.standard_error, 0.5 / 256.0, 0.36 * 0.5 / 256.0);
}

TEST(Overlap, ShrinksFromTheFramesEdgeAndFromWhatIsNotInCommon) {
    const formats::Image image = formats::make_image(9, 7, {"Y"});
    Overlap overlap = whole_frame(image);
    EXPECT_EQ(std::ranges::count(shrunk(overlap, 9, 7, 2), 255), 5 * 3);
    overlap[3 * 9 + 4] = 0;
    EXPECT_EQ(std::ranges::count(shrunk(overlap, 9, 7, 1), 255), 7 * 5 - 9);
}

}  // namespace
}  // namespace lensproof::calibration::metrics_test
