#include "calibration/chromatic/chromatic_shift.h"

#include <gtest/gtest.h>

#include "engine/base/input_error.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::chromatic_shift_test {

constexpr std::array<double, 3> kRadial = {1.4, -0.8, 0.3};
constexpr std::array<double, 2> kTangential = {0.2, -0.1};
constexpr Vec2d kTranslation{0.12, -0.05};
constexpr Vec2d kCentre{330.0, 250.0};
constexpr double kHalfDiagonal = 400.0;

double shift_at(double h) {
    return h * (kRadial[0] + h * h * (kRadial[1] + h * h * kRadial[2]));
}

std::vector<ChromaticPair> pairs_with_noise(double sigma, synthetic::Noise& noise) {
    std::vector<ChromaticPair> pairs;
    for (int y = 20; y < 480; y += 40) {
        for (int x = 20; x < 640; x += 40) {
            const Vec2d q{(x - kCentre.x) / kHalfDiagonal, (y - kCentre.y) / kHalfDiagonal};
            const double h = std::hypot(q.x, q.y);
            const double scale = h > 0.0 ? shift_at(h) / h : kRadial[0];
            const double turn = kTangential[0] + h * h * kTangential[1];
            pairs.push_back({{double(x), double(y)},
                             {x + scale * q.x - turn * q.y + kTranslation.x + sigma * noise(),
                              y + scale * q.y + turn * q.x + kTranslation.y + sigma * noise()}});
        }
    }
    return pairs;
}

// The model is linear, so without noise the answer is exact up to rounding of 640 px coordinates.
TEST(CalibrationChromaticShift, ExactShiftsComeBack) {
    synthetic::Noise noise(1);
    const ChromaticShift shift = fit_chromatic_shift(pairs_with_noise(0.0, noise), kCentre, kHalfDiagonal);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(shift.radial_px[i], kRadial[i], 1e-9);
    }
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_NEAR(shift.tangential_px[i], kTangential[i], 1e-9);
    }
    EXPECT_NEAR(shift.translation_px.x, kTranslation.x, 1e-10);
    EXPECT_NEAR(shift.translation_px.y, kTranslation.y, 1e-10);
    EXPECT_NEAR(sample(shift.radial, 0.8)->value, shift_at(0.8), 1e-9);
}

// 500 repetitions: 93 to 97 %, give or take two binomial standard deviations of 1 %. One pair in 48 is an outlier by 3
// px.
TEST(CalibrationChromaticShift, BandsCoverTheTruthInSpiteOfOutliers) {
    synthetic::Noise noise(2);
    constexpr int trials = 500;
    int covered[6] = {0, 0, 0, 0, 0, 0};
    const double heights[3] = {0.25, 0.5, 0.9};
    for (int trial = 0; trial < trials; ++trial) {
        auto pairs = pairs_with_noise(0.04, noise);
        for (std::size_t i = 11; i < pairs.size(); i += 48) {
            pairs[i].channel_px.x += 3.0;
        }
        const ChromaticShift shift = fit_chromatic_shift(pairs, kCentre, kHalfDiagonal);
        for (int k = 0; k < 3; ++k) {
            const Banded band = sample(shift.radial, heights[k]).value();
            covered[k] += shift_at(heights[k]) > band.lower_95 && shift_at(heights[k]) < band.upper_95 ? 1 : 0;
            const Banded turn = sample(shift.tangential, heights[k]).value();
            const double truth = heights[k] * (kTangential[0] + heights[k] * heights[k] * kTangential[1]);
            covered[3 + k] += truth > turn.lower_95 && truth < turn.upper_95 ? 1 : 0;
            EXPECT_NEAR(band.value, shift_at(heights[k]), 0.04);
        }
    }
    for (const int count : covered) {
        EXPECT_GE(count, (0.93 - 0.02) * trials);
        EXPECT_LE(count, (0.97 + 0.02) * trials);
    }
}

TEST(CalibrationChromaticShift, TheCurveEndsWhereThePointsEnd) {
    synthetic::Noise noise(3);
    auto pairs = pairs_with_noise(0.01, noise);
    std::erase_if(pairs, [](const ChromaticPair& p) {
        return std::hypot(p.green_px.x - kCentre.x, p.green_px.y - kCentre.y) > 0.6 * kHalfDiagonal;
    });
    const ChromaticShift shift = fit_chromatic_shift(pairs, kCentre, kHalfDiagonal);
    EXPECT_LE(shift.radial.image_height.back(), 0.6);
    EXPECT_FALSE(sample(shift.radial, 0.7));
}

TEST(CalibrationChromaticShift, TooFewOrUselessPairsAreRefused) {
    EXPECT_THROW(fit_chromatic_shift({}, kCentre, kHalfDiagonal), InputError);
    EXPECT_THROW(fit_chromatic_shift(std::vector<ChromaticPair>(20, {{100, 100}, {101, 100}}), kCentre, kHalfDiagonal),
                 InputError);
    EXPECT_THROW(
        fit_chromatic_shift(std::vector<ChromaticPair>(20, {{std::nan(""), 100}, {101, 100}}), kCentre, kHalfDiagonal),
        InputError);
}

}  // namespace lensproof::calibration::chromatic_shift_test
