// Against the libraries' long double.
#include "engine/base/elementary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace lensproof::elementary_test {

/// Of a value, in its last place.
template <class T>
double error_ulp(T found, long double exact) {
    const T rounded = static_cast<T>(exact);
    const T ulp = std::nextafter(std::abs(rounded), std::numeric_limits<T>::infinity()) - std::abs(rounded);
    return static_cast<double>(std::abs(static_cast<long double>(found) - exact) / static_cast<long double>(ulp));
}

template <class T>
double worst_exponential(double deepest) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    double worst = 0.0;
    for (int i = 0; i < 200000; ++i) {
        const auto x = static_cast<T>(-deepest * unit(random) * (i % 2 == 0 ? 1.0 : 1e-3));
        worst = std::max(worst, error_ulp<T>(exponential_of_negative(x), std::exp(static_cast<long double>(x))));
    }
    return worst;
}

// The x87's long double has eleven bits more than a double: it judges to 0.001 ulp.
TEST(Elementary, ExponentialsAreWithinTwoUlp) {
    EXPECT_LT(worst_exponential<double>(708.0), 2.0);
    EXPECT_LT(worst_exponential<float>(87.0), 2.0);
    EXPECT_EQ(exponential_of_negative(0.0), 1.0);
    EXPECT_EQ(exponential_of_negative(-0.0F), 1.0F);
}

template <class T>
void expect_the_same_near_zero() {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int i = 0; i < 20000; ++i) {
        const auto x = static_cast<T>(kNearZero<T> * unit(random) * (i % 2 == 0 ? 1.0 : 1e-3));
        EXPECT_EQ(exponential_near_zero(x), exponential_of_negative(x)) << x;
    }
    EXPECT_EQ(exponential_near_zero(-kNearZero<T>), exponential_of_negative(-kNearZero<T>));
}

TEST(Elementary, ExponentialsNearZeroHaveTheSameBits) {
    expect_the_same_near_zero<double>();
    expect_the_same_near_zero<float>();
}

TEST(Elementary, ExponentialsEndAtTheSmallestNormalNumber) {
    EXPECT_EQ(exponential_of_negative(-1e300), 0.0);
    EXPECT_EQ(exponential_of_negative(-std::numeric_limits<double>::infinity()), 0.0);
    EXPECT_GT(exponential_of_negative(-707.9), std::numeric_limits<double>::min());
    EXPECT_GT(exponential_of_negative(-86.9F), std::numeric_limits<float>::min());
    EXPECT_TRUE(std::isnan(exponential_of_negative(std::numeric_limits<double>::quiet_NaN())));
}

TEST(Elementary, SinesAreWithinTwoUlp) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> eighth(-0.7853981633974483, 0.7853981633974483);
    double worst = 0.0;
    for (int i = 0; i < 200000; ++i) {
        const double x = eighth(random) * (i % 2 == 0 ? 1.0 : 1e-4);
        const Vec2d found = cos_sin_within_eighth(x);
        worst = std::max(worst, error_ulp(found.x, std::cos(static_cast<long double>(x))));
        worst = std::max(worst, error_ulp(found.y, std::sin(static_cast<long double>(x))));
    }
    EXPECT_LT(worst, 2.0);
}

/// Of any turn, in ulps of 1.
template <class T>
double worst_turn() {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> all(-1.0, 1.0);
    double worst = 0.0;
    for (int i = 0; i < 200000; ++i) {
        const auto x = static_cast<T>(all(random) * (i % 2 == 0 ? double{kMostTurned<T>} : 20.0));
        const Vec2<T> found = cos_sin(x);
        const auto away = [&](T number, long double exact) {
            return static_cast<double>(std::abs(static_cast<long double>(number) - exact)) /
                   double{std::numeric_limits<T>::epsilon()};
        };
        worst = std::max(worst, away(found.x, std::cos(static_cast<long double>(x))));
        worst = std::max(worst, away(found.y, std::sin(static_cast<long double>(x))));
    }
    return worst;
}

TEST(Elementary, TurnsAreWithinAnUlpOfOne) {
    EXPECT_LT(worst_turn<double>(), 1.0);
    EXPECT_LT(worst_turn<float>(), 1.0);
    for (const double x : {0.0, -0.0, 1e-300}) {
        EXPECT_EQ(cos_sin(x), (Vec2d{1.0, x}));
    }
    EXPECT_EQ(cos_sin(1e9), (Vec2d{std::cos(1e9), std::sin(1e9)}));  // beyond what is reduced here
}

// All quadrants, from directions near the axes and the eighths that it counts from to any.
TEST(Elementary, TurnsOfDirectionsAreWithinAnUlpOfOne) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> all(-1.0, 1.0);
    double worst = 0.0;
    for (int i = 0; i < 400000; ++i) {
        const double near = std::round(16.0 * all(random)) / 16.0 + std::pow(10.0, -16.0 * std::abs(all(random)));
        const double turns = i % 2 == 0 ? all(random) : near;
        const double scale = std::pow(10.0, 100.0 * all(random));
        const double x = scale * std::cos(2.0 * std::numbers::pi * turns);
        const double y = scale * std::sin(2.0 * std::numbers::pi * turns);
        const long double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x)) /
                                  (2.0L * std::numbers::pi_v<long double>);
        worst = std::max(worst, static_cast<double>(std::abs(static_cast<long double>(turns_of(x, y)) - exact)));
    }
    EXPECT_LT(worst, std::numeric_limits<double>::epsilon());
    EXPECT_EQ(turns_of(0.0, 0.0), 0.0);
    EXPECT_EQ(turns_of(-1.0, 0.0), 0.5);
    EXPECT_EQ(turns_of(0.0, -1.0), -0.25);
}

}  // namespace lensproof::elementary_test
