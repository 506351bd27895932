// What residuals show of their causes: noise, a lens that is off along the radius, one that is decentred.
#include "calibration/statistics/residual_curves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace lensproof::calibration::residual_curves_test {

constexpr int kWidth = 600;
constexpr int kHeight = 400;
constexpr Vec2d kCentre{310.0, 190.0};
const double kHalfDiagonal = 0.5 * std::hypot(kWidth, kHeight);

/// Points all over the frame, each off by what `by` says of its offset from the centre.
template <class By>
std::vector<PlacedResidual> residuals(const By& by, int count = 20000) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<PlacedResidual> points;
    points.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        const Vec2d at{uniform(random) * (kWidth - 1), uniform(random) * (kHeight - 1)};
        points.push_back({at, by(at - kCentre, random)});
    }
    return points;
}

Vec2d noise(const Vec2d&, std::mt19937_64& random) {
    std::normal_distribution<double> normal(0.0, 0.2);
    const double x = normal(random);
    return {x, normal(random)};
}

/// The fraction of samples whose 95 % bounds hold what `expected` says there.
template <class Expected>
double held(const Curve& curve, const Expected& expected) {
    double inside = 0.0;
    for (std::size_t i = 0; i < curve.value.size(); ++i) {
        const double y = expected(curve.image_height[i]);
        inside += curve.lower_95[i] <= y && y <= curve.upper_95[i] ? 1.0 : 0.0;
    }
    return inside / static_cast<double>(curve.value.size());
}

/// Of twenty bounds of 95 % five or more miss the truth once in four hundred (binomial); the seed is fixed.
constexpr double kLeastHeld = 0.8;

TEST(ResidualCurves, NoiseIsGaussianAndHasNoMean) {
    const ResidualCurves curves = residual_curves(residuals(noise), kCentre, kHalfDiagonal);
    EXPECT_NEAR(curves.rms_px, 0.2, 4.0 * 0.2 / std::sqrt(2.0 * 40000.0));
    EXPECT_NEAR(curves.beyond_3, 0.0027, 4.0 * std::sqrt(0.0027 / 40000.0));
    const Curve gaussian = gaussian_density(curves.density);
    double area = 0.0;
    for (std::size_t i = 0; i < curves.density.value.size(); ++i) {
        area += 0.25 * curves.density.value[i];
        // The mean over a bin is not the value at its middle: h² / 24 of the second derivative, at most 0.4.
        EXPECT_NEAR(curves.density.value[i], gaussian.value[i],
                    0.0011 + 5.0 * std::sqrt((gaussian.value[i] + 1e-4) / (0.25 * 40000.0)))
            << curves.density.image_height[i];
    }
    EXPECT_NEAR(area, 1.0, 1e-3);
    const auto none = [](double) { return 0.0; };
    for (const Curve* curve :
         {&curves.radial, &curves.tangential, &curves.radial_azimuth, &curves.tangential_azimuth}) {
        EXPECT_GE(curve->value.size(), 20U);
        EXPECT_GE(held(*curve, none), kLeastHeld);
    }
}

TEST(ResidualCurves, TailsAreSeen) {
    const auto with_outliers = [](const Vec2d& from, std::mt19937_64& random) {
        return random() % 50 == 0 ? Vec2d{3.0, -3.0} : noise(from, random);
    };
    const ResidualCurves curves = residual_curves(residuals(with_outliers), kCentre, kHalfDiagonal);
    EXPECT_NEAR(curves.beyond_3, 0.02, 0.004);  // a fiftieth of 20000 points, ± four standard errors
}

TEST(ResidualCurves, ARadialErrorStandsAlongTheRadius) {
    const auto cubic = [](double height) { return 0.8 * std::pow(height, 3); };
    const auto by = [&](const Vec2d& from, std::mt19937_64& random) {
        return noise(from, random) + cubic(length(from) / kHalfDiagonal) / length(from) * from;
    };
    const ResidualCurves curves = residual_curves(residuals(by), kCentre, kHalfDiagonal);
    EXPECT_GE(held(curves.radial, cubic), kLeastHeld);
    EXPECT_GE(held(curves.tangential, [](double) { return 0.0; }), kLeastHeld);
    EXPECT_LT(held(curves.radial, [](double) { return 0.0; }), 0.5);
}

TEST(ResidualCurves, AShiftIsOneWaveAround) {
    const auto by = [](const Vec2d& from, std::mt19937_64& random) { return noise(from, random) + Vec2d{0.1, 0.0}; };
    const ResidualCurves curves = residual_curves(residuals(by), kCentre, kHalfDiagonal);
    const auto wave = [](double azimuth_deg) { return 0.1 * std::cos(azimuth_deg * std::numbers::pi / 180.0); };
    EXPECT_GE(held(curves.radial_azimuth, wave), kLeastHeld);
    // Tangential is a quarter turn on, from right to down.
    EXPECT_GE(held(curves.tangential_azimuth, [&](double azimuth) { return wave(azimuth + 90.0); }), kLeastHeld);
}

TEST(ResidualCurves, BinsOfFewPointsAreLeftOut) {
    const ResidualCurves curves = residual_curves(residuals(noise, 12), kCentre, kHalfDiagonal);
    EXPECT_TRUE(curves.radial.value.empty());
    EXPECT_EQ(curves.density.value.size(), 40U);
}

TEST(ResidualCurves, TheMapShowsWhereTheyAreOff) {
    const auto by = [](const Vec2d& from, std::mt19937_64& random) {
        return (from.x > 0.0 ? 3.0 : 1.0) * noise(from, random);
    };
    std::vector<PlacedResidual> all = residuals(by);
    std::erase_if(all,
                  [](const PlacedResidual& residual) { return residual.at_px.x > 400.0 && residual.at_px.y > 250.0; });
    const std::vector<double> map = local_rms_px(all, kWidth, kHeight, 13, 9);
    ASSERT_EQ(map.size(), 13U * 9U);
    // About 150 points count at each place: an rms of 300 coordinates is known to 4 %. Five times that.
    EXPECT_NEAR(map[4 * 13 + 1], 0.2, 0.2 * 0.2);
    EXPECT_NEAR(map[2 * 13 + 11], 0.6, 0.6 * 0.2);
    EXPECT_TRUE(std::isnan(map[9 * 13 - 1]));  // no point is near the lower right corner
}

}  // namespace lensproof::calibration::residual_curves_test
