// Pixels drawn as often as they weigh.
#include "engine/scene/light/pixel_distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace lensproof::scene::pixel_distribution_test {

constexpr int kWidth = 37;
constexpr int kHeight = 11;

/// Of many magnitudes, a third of them 0, the last row and the last column among these.
std::vector<float> weights() {
    std::mt19937_64 bits(1);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<float> weights;
    for (int row = 0; row < kHeight; ++row) {
        for (int column = 0; column < kWidth; ++column) {
            const bool is_black = uniform(bits) < 1.0 / 3.0 || row == kHeight - 1 || column == kWidth - 1;
            weights.push_back(is_black ? 0.0F : static_cast<float>(std::pow(10.0, 8.0 * uniform(bits) - 4.0)));
        }
    }
    return weights;
}

std::vector<double> row_factors() {
    std::vector<double> factors(kHeight);
    std::iota(factors.begin(), factors.end(), 1.0);
    return factors;
}

/// Of every pixel, row after row, as the weights say.
std::vector<double> expected() {
    std::vector<double> expected;
    double sum = 0.0;
    const std::vector<float> given = weights();
    for (std::size_t i = 0; i < given.size(); ++i) {
        expected.push_back(given[i] * row_factors()[i / kWidth]);
        sum += expected.back();
    }
    for (double& probability : expected) {
        probability /= sum;
    }
    return expected;
}

// Probabilities are products of whole numbers of 2⁻³²: they add up to 1 and nothing else, but for the sum's own
// rounding, 407 of half an ulp. Each is what the weights say to the one part in 2³² of its row and of its row's in the
// whole that every lit step is given first: 40 a row, 12 in all. Nothing with a weight is left out.
TEST(PixelDistribution, ProbabilitiesFollowWeightsAndAddUpToOne) {
    const PixelDistribution pixels(kWidth, weights(), row_factors());
    const std::vector<double> wanted = expected();
    double sum = 0.0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        const double probability = pixels.probability(i % kWidth, i / kWidth);
        sum += probability;
        EXPECT_NEAR(probability, wanted[i], (40 + 12) * 0x1p-32) << i;
        EXPECT_TRUE(probability > 0.0 || wanted[i] == 0.0) << i;
    }
    EXPECT_NEAR(sum, 1.0, 407 * 0x1p-53);
}

// The square that numbers come from is cut into rectangles, one for each pixel, of its probability: along each row of a
// fine grid of numbers, the fraction that falls to a pixel is its share of its row to the grid's step at either end,
// and where a number falls within its pixel is even, so that pixel and place together grow with the number.
TEST(PixelDistribution, DrawsWithItsProbabilities) {
    const PixelDistribution pixels(kWidth, weights(), row_factors());
    constexpr int kRows = 400;
    constexpr int kSteps = 4000;
    std::vector<double> rows(kHeight, 0.0);
    for (int i = 0; i < kRows; ++i) {
        const double u1 = (i + 0.5) / kRows;
        std::vector<double> found(kWidth, 0.0);
        double before = 0.0;
        std::size_t row = 0;
        for (int k = 0; k < kSteps; ++k) {
            const PixelDistribution::Draw draw = pixels.draw(u1, (k + 0.5) / kSteps);
            ASSERT_DOUBLE_EQ(draw.probability, pixels.probability(draw.column, draw.row));
            ASSERT_GT(draw.probability, 0.0);
            ASSERT_GE(draw.x, before);
            ASSERT_EQ(static_cast<std::size_t>(draw.x * kWidth), draw.column);
            before = draw.x;
            row = draw.row;
            found[draw.column] += 1.0 / kSteps;
        }
        rows[row] += 1.0 / kRows;
        double of_row = 0.0;
        for (std::size_t column = 0; column < kWidth; ++column) {
            of_row += pixels.probability(column, row);
        }
        for (std::size_t column = 0; column < kWidth; ++column) {
            EXPECT_NEAR(found[column], pixels.probability(column, row) / of_row, 2.0 / kSteps);
        }
    }
    for (std::size_t row = 0; row < kHeight; ++row) {
        double of_row = 0.0;
        for (std::size_t column = 0; column < kWidth; ++column) {
            of_row += pixels.probability(column, row);
        }
        EXPECT_NEAR(rows[row], of_row, 2.0 / kRows);
    }
}

// The ends of the numbers, and pictures of a single pixel, row or column.
TEST(PixelDistribution, EndsAreInside) {
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 40), std::pair(40, 1), std::pair(33, 17)}) {
        const PixelDistribution pixels(
            width, std::vector<float>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.3F),
            std::vector<double>(static_cast<std::size_t>(height), 2.0));
        for (const double u : {0.0, 0x1p-53, 0.5, 1.0 - 0x1p-53}) {
            const PixelDistribution::Draw draw = pixels.draw(u, u);
            EXPECT_NEAR(draw.x, u, 0x1p-31);
            EXPECT_NEAR(draw.y, u, 0x1p-31);
            EXPECT_NEAR(draw.probability * width * height, 1.0, width * height * 0x1p-31);
        }
    }
}

}  // namespace lensproof::scene::pixel_distribution_test
