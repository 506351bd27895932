#include "calibration/detection/star_place.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/calibration/lines/line_pictures.h"

namespace lensproof::calibration::star_place_test {

using namespace synthetic;

// The Gaussian's light in each pixel, exactly.
void add_star(formats::Image& image, const Vec2d& at, double sigma_px, double light) {
    const auto part = [&](int pixel, double middle) {
        const double scale = 1.0 / (sigma_px * std::numbers::sqrt2);
        return 0.5 * (std::erf((pixel + 0.5 - middle) * scale) - std::erf((pixel - 0.5 - middle) * scale));
    };
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            image.at(x, y, 0) += static_cast<float>(light * part(x, at.x) * part(y, at.y));
        }
    }
}

formats::Image sky(double light = 0.02) {
    formats::Image image = formats::make_image(64, 64, {"G"});
    std::ranges::fill(image.pixels, static_cast<float>(light));
    return image;
}

// What pixels miss between them: of Gaussians of the variances v (the pixel's box with it) and w, the weight, the first
// moment of the product, of variance p = v w / (v + w), is sampled with an error of 4π p exp(−2π² p) along each axis
// (Poisson's sum formula), and of that 1 + v / w comes to the place. Beside it 1e-3 px for where rounds end.
double missed_px(double sigma_px) {
    const double v = sigma_px * sigma_px + 1.0 / 12.0;
    const double w = std::max(v, 1.0);
    const double p = v * w / (v + w);
    return std::numbers::sqrt2 * (1.0 + v / w) * 4.0 * kPi * p * std::exp(-2.0 * kPi * kPi * p) + 1e-3;
}

TEST(StarPlace, IsTheStarsOwn) {
    Chance chance(1);
    for (const double sigma : {0.6, 0.9, 1.4, 1.9}) {
        for (int i = 0; i < 25; ++i) {
            const Vec2d at{chance(28.0, 36.0), chance(28.0, 36.0)};
            formats::Image image = sky(i % 2 == 0 ? 0.02 : 0.0);
            add_star(image, at, sigma, 3.0);
            const auto place = locate_star(image, 0, at + Vec2d{chance(-4.0, 4.0), chance(-4.0, 4.0)}, 8.0);
            ASSERT_TRUE(place) << sigma;
            EXPECT_LT(length(place->centre_px - at), missed_px(sigma)) << sigma << " at " << at.x << ", " << at.y;
        }
    }
}

// 200 places tell their scatter to 5 %; the noise itself is known to 2 % from a thousand pixels.
TEST(StarPlace, ItsErrorIsItsScatter) {
    double squares = 0.0;
    double stated = 0.0;
    constexpr int kTrials = 200;
    for (unsigned trial = 0; trial < kTrials; ++trial) {
        Chance chance(500 + trial);
        const Vec2d at{chance(30.0, 33.0), chance(30.0, 33.0)};
        formats::Image image = sky();
        add_star(image, at, 1.2, 1.0);
        add_noise(image, 0.01, trial);
        const auto place = locate_star(image, 0, {31.5, 31.5}, 8.0);
        ASSERT_TRUE(place);
        squares += dot(place->centre_px - at, place->centre_px - at) / (2.0 * kTrials);
        stated += dot(place->standard_error_px, place->standard_error_px) / (2.0 * kTrials);
    }
    EXPECT_NEAR(std::sqrt(stated / squares), 1.0, 0.2);
}

TEST(StarPlace, TheBrightestOfTwo) {
    formats::Image image = sky();
    add_star(image, {30.0, 30.0}, 1.0, 0.5);
    add_star(image, {37.0, 33.0}, 1.0, 2.0);
    const auto place = locate_star(image, 0, {32.0, 31.0}, 8.0);
    ASSERT_TRUE(place);
    EXPECT_LT(length(place->centre_px - Vec2d{37.0, 33.0}), 0.05);
    const auto near = locate_star(image, 0, {29.0, 30.0}, 5.0);
    ASSERT_TRUE(near);
    EXPECT_LT(length(near->centre_px - Vec2d{30.0, 30.0}), 0.15);
}

TEST(StarPlace, NoneWhereThereIsNone) {
    formats::Image image = sky();
    add_noise(image, 0.01, 3);
    EXPECT_FALSE(locate_star(image, 0, {31.0, 31.0}, 8.0));
    EXPECT_FALSE(locate_star(sky(), 0, {31.0, 31.0}, 8.0));
    EXPECT_FALSE(locate_star(sky(), 0, {-500.0, 1e9}, 8.0));
    EXPECT_FALSE(locate_star(sky(), 0, {1e300, -1e300}, 8.0));
    EXPECT_FALSE(locate_star(sky(), 0, {std::numeric_limits<double>::quiet_NaN(), 3.0}, 8.0));
    add_star(image, {31.0, 31.0}, 1.0, 2.0);
    image.at(33, 31, 0) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(locate_star(image, 0, {31.0, 31.0}, 8.0));
    formats::Image far = sky();
    add_star(far, {50.0, 31.0}, 1.0, 2.0);
    EXPECT_FALSE(locate_star(far, 0, {31.0, 31.0}, 8.0));
}

}  // namespace lensproof::calibration::star_place_test
