// tests/validation/photon_transfer_test.cpp — a sensor's noise, as one measures a camera's: flat fields, their means
// and variances, their histograms. Seeds are fixed; the limits are those that one run in a million would pass by
// chance.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/poisson.hpp>
#include <cmath>
#include <numeric>
#include <vector>

#include "engine/render/raw/raw_sensor.h"

namespace lensproof::photon_transfer_test {

constexpr int kSide = 400;
constexpr double kCount = kSide * kSide;
constexpr double kSigmas = 4.9;  // two-sided, 1e-6

/// A monochrome sensor of 16 bits.
render::RawSensor sensor_of(double full_well_electrons, double read_noise_electrons, int black_level, int white_level) {
    return {.full_well_electrons = full_well_electrons,
            .read_noise_electrons = read_noise_electrons,
            .bits = 16,
            .black_level_dn = black_level,
            .white_level_dn = white_level,
            .camera = {.response = "luminance", .exposure = {.time_s = 0.5, .iso = 100.0}},
            .channels = 1,
            .neutral = {1.0, 0.0, 0.0}};
}

std::vector<std::uint16_t> flat_field(const render::RawSensor& sensor, double light, std::uint64_t seed,
                                      int side = kSide) {
    formats::Image film = formats::make_image(side, side, {"R", "G", "B"});
    std::ranges::fill(film.pixels, static_cast<float>(light));
    return render::expose(sensor, film, seed).mosaic.values;
}

struct Moments {
    double mean = 0.0;
    double variance = 0.0;
};

Moments moments_of(const std::vector<std::uint16_t>& values) {
    const auto count = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
    double squares = 0.0;
    for (const std::uint16_t value : values) {
        squares += (value - mean) * (value - mean);
    }
    return {.mean = mean, .variance = squares / (count - 1.0)};
}

/// The standard error of a variance from `kCount` values of Poisson electrons with Gaussian noise: of a normal's, with
/// the Poisson's fourth cumulant, its mean: √(2 σ⁴/(n − 1) + κ₄/n).
double variance_error(double electrons, double variance_electrons) {
    return std::sqrt(2.0 * variance_electrons * variance_electrons / (kCount - 1.0) + electrons / kCount);
}

// The photon transfer curve (Janesick, Photon Transfer, SPIE 2007): var(DN) = K (mean(DN) − black) + K² σ_read² + 1/12,
// the last by rounding. At each level on its own, then the line through all: its slope is the gain, its intercept the
// read noise.
TEST(RawSensor, HasThePhotonTransferCurveOfItsGainAndReadNoise) {
    for (const double iso : {100.0, 800.0}) {
        render::RawSensor sensor = sensor_of(40000.0, 6.0, 1024, 16383);
        sensor.camera.exposure.iso = iso;
        const double electrons_at_white = 40000.0 * 100.0 / iso;
        const double gain = (16383.0 - 1024.0) / electrons_at_white;
        const double floor = gain * gain * 36.0 + 1.0 / 12.0;
        double w = 0.0;
        double wx = 0.0;
        double wy = 0.0;
        double wxx = 0.0;
        double wxy = 0.0;
        std::uint64_t seed = 1;
        for (const double light : {0.0, 0.001, 0.003, 0.01, 0.03, 0.06, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9}) {
            const double electrons = static_cast<float>(light) * electrons_at_white;
            const Moments found = moments_of(flat_field(sensor, light, seed++));
            const double variance = gain * gain * electrons + floor;
            const double error = gain * gain * variance_error(electrons, variance / gain / gain);
            EXPECT_NEAR(found.mean, 1024.0 + gain * electrons, kSigmas * std::sqrt(variance / kCount)) << light;
            EXPECT_NEAR(found.variance, variance, kSigmas * error) << light;
            const double weight = 1.0 / (error * error);
            const double x = found.mean - 1024.0;
            w += weight;
            wx += weight * x;
            wy += weight * found.variance;
            wxx += weight * x * x;
            wxy += weight * x * found.variance;
        }
        // A weighted line's own standard errors; those of the means are 1/gain of their part and less, left out.
        const double determinant = w * wxx - wx * wx;
        const double slope = (w * wxy - wx * wy) / determinant;
        const double intercept = (wxx * wy - wx * wxy) / determinant;
        EXPECT_NEAR(slope, gain, kSigmas * std::sqrt(w / determinant)) << iso;
        EXPECT_NEAR(intercept, floor, kSigmas * std::sqrt(wxx / determinant)) << iso;
        RecordProperty("iso_" + std::to_string(static_cast<int>(iso)) + "_gain", std::to_string(slope / gain));
    }
}

// At one DN an electron and without read noise, raw values are counts of electrons: their histogram against Poisson's
// probabilities by χ². Both of the sampler's methods, on both sides of the mean of 10 where they change.
TEST(RawSensor, CountsElectronsAsPoissonDoes) {
    for (const double mean : {0.02, 0.3, 1.0, 4.0, 9.99, 10.01, 17.0, 60.0, 900.0}) {
        const render::RawSensor sensor = sensor_of(65535.0, 0.0, 0, 65535);
        const std::vector<std::uint16_t> values = flat_field(sensor, mean / 65535.0, 11);
        const double of_film = static_cast<double>(static_cast<float>(mean / 65535.0)) * 65535.0;
        const boost::math::poisson_distribution<> poisson(of_film);
        std::vector<double> found(2000, 0.0);
        for (const std::uint16_t value : values) {
            ASSERT_LT(value, found.size());
            found[value] += 1.0;
        }
        // Counts in a row are taken together until ten are expected; what is left joins the last.
        double chi_squared = 0.0;
        int bins = 0;
        double expected_in_bin = 0.0;
        double found_in_bin = 0.0;
        double expected_left = kCount;
        for (std::size_t k = 0; k < found.size(); ++k) {
            expected_in_bin += kCount * pdf(poisson, k);
            found_in_bin += found[k];
            if (expected_in_bin >= 10.0 && expected_left - expected_in_bin >= 10.0) {
                chi_squared += (found_in_bin - expected_in_bin) * (found_in_bin - expected_in_bin) / expected_in_bin;
                expected_left -= expected_in_bin;
                expected_in_bin = found_in_bin = 0.0;
                ++bins;
            }
        }
        chi_squared += (found_in_bin - expected_left) * (found_in_bin - expected_left) / expected_left;
        ASSERT_GE(bins, 1) << mean;
        EXPECT_LT(chi_squared, quantile(complement(boost::math::chi_squared(bins), 1e-6))) << mean;
    }
}

// Read noise is Gaussian: the largest distance between the distribution of a dark frame, in steps of 1/600 σ, and the
// normal one (Kolmogorov and Smirnov). One run in a million passes √(ln(2e6) / 2n); half a step is 3e-4 of it.
TEST(RawSensor, ReadsWithGaussianNoise) {
    const render::RawSensor sensor = sensor_of(100.0, 1.0, 5000, 65000);
    std::vector<std::uint16_t> values = flat_field(sensor, 0.0, 5);
    std::ranges::sort(values);
    const boost::math::normal_distribution<> normal(5000.0, 600.0);
    double farthest = 0.0;
    for (std::size_t i = 0; i + 1 < values.size(); ++i) {
        if (values[i + 1] != values[i]) {
            farthest = std::max(farthest, std::abs(static_cast<double>(i + 1) / kCount - cdf(normal, values[i] + 0.5)));
        }
    }
    EXPECT_LT(farthest, std::sqrt(std::log(2e6) / (2.0 * kCount)) + 1e-9);
}

// Raw values grow with the light to saturation, and then no more: at twice what saturates every one is the white level,
// and at 1 about half of them, those whose noise is above.
TEST(RawSensor, IsLinearToSaturationAndThenWhite) {
    const render::RawSensor sensor = sensor_of(20000.0, 3.0, 512, 16383);
    for (const double light : {0.02, 0.25, 0.5, 0.75, 0.95}) {  // at the last, white is 7 σ away
        const double error = std::sqrt((light * 20000.0 + 9.0) / kCount) / 20000.0;
        const double linear = (moments_of(flat_field(sensor, light, 21)).mean - 512.0) / (16383.0 - 512.0);
        EXPECT_NEAR(linear, static_cast<float>(light), kSigmas * error);
    }
    const std::vector<std::uint16_t> at_white = flat_field(sensor, 1.0, 22);
    // Those that round to white: half, and what lies within half of a step of 1.26 electrons, 0.0018 σ-wide shares.
    const double fraction = static_cast<double>(std::ranges::count(at_white, 16383)) / kCount;
    EXPECT_NEAR(fraction, 0.5, kSigmas * 0.5 / kSide + 0.004);
    const std::vector<std::uint16_t> beyond = flat_field(sensor, 2.0, 23);
    EXPECT_EQ(std::ranges::count(beyond, 16383), static_cast<std::ptrdiff_t>(beyond.size()));
}

// Dark electrons come with time, bring their own Poisson noise, and add to the light's.
TEST(RawSensor, DarkCurrentAddsElectronsAndTheirNoise) {
    render::RawSensor sensor = sensor_of(20000.0, 3.0, 512, 16383);
    sensor.dark_current_electrons_per_s = 400.0;  // in half a second 200
    const double gain = (16383.0 - 512.0) / 20000.0;
    const Moments found = moments_of(flat_field(sensor, 0.0, 31));
    const double variance = 200.0 + 9.0 + 1.0 / 12.0 / gain / gain;
    EXPECT_NEAR((found.mean - 512.0) / gain, 200.0, kSigmas * std::sqrt(variance / kCount));
    EXPECT_NEAR(found.variance / gain / gain, variance, kSigmas * variance_error(200.0, variance));
}

// No pixel knows of another, and no seed of another: correlations are within 1/√n of none.
TEST(RawSensor, NoiseOfPixelsAndOfSeedsIsIndependent) {
    const render::RawSensor sensor = sensor_of(20000.0, 3.0, 512, 16383);
    const std::vector<std::uint16_t> values = flat_field(sensor, 0.1, 41);
    const std::vector<std::uint16_t> others = flat_field(sensor, 0.1, 42);
    const Moments moments = moments_of(values);
    const auto correlation = [&](const std::vector<std::uint16_t>& with, std::size_t shift) {
        double sum = 0.0;
        for (std::size_t i = 0; i + shift < values.size(); ++i) {
            sum += (values[i] - moments.mean) * (with[i + shift] - moments.mean);
        }
        return sum / (moments.variance * kCount);
    };
    for (const std::size_t shift : {1, 2, kSide, kSide + 1}) {
        EXPECT_NEAR(correlation(values, shift), 0.0, kSigmas / kSide) << shift;
    }
    for (const std::size_t shift : {0, 1}) {
        EXPECT_NEAR(correlation(others, shift), 0.0, kSigmas / kSide) << shift;
    }
}

}  // namespace lensproof::photon_transfer_test
