// Places of a picture, drawn where it is bright.
#include "engine/scene/light/pixel_distribution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace lensproof::scene::pixel_distribution_test {

constexpr int kWidth = 64;
constexpr int kHeight = 32;

std::size_t index_of(int x, int y, int width = kWidth) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

/// Of many magnitudes, a third of them 0, the last row of blocks and the last column among these.
std::vector<double> magnitudes() {
    std::mt19937_64 bits(1);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<double> values;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const bool is_black = uniform(bits) < 1.0 / 3.0 || y >= kHeight - 4 || x == kWidth - 1;
            values.push_back(is_black ? 0.0 : std::pow(10.0, 4.0 * uniform(bits) - 2.0));
        }
    }
    return values;
}

PixelDistribution distribution_of(int width, int height, const std::vector<double>& values) {
    return {width, height, [&](int row) {
                std::vector<double> squares;
                for (int x = 0; x < width; ++x) {
                    const double value = values[index_of(x, row, width)];
                    squares.push_back(value * value);
                }
                return squares;
            }};
}

/// The centre of a pixel.
Vec2d centre(int x, int y, int width = kWidth, int height = kHeight) {
    return {(x + 0.5) / width, (y + 0.5) / height};
}

/// Of every pixel, row after row, as bright as it is.
std::vector<double> expected() {
    std::vector<double> expected = magnitudes();
    const double sum = std::accumulate(expected.begin(), expected.end(), 0.0);
    std::ranges::transform(expected, expected.begin(), [sum](double value) { return value / sum; });
    return expected;
}

// Every pixel of so small a picture is a cell, and as probable as it is bright, but for the 2⁻¹⁶ of its block that each
// of up to 32 cells is given first and what rounding takes, one more; those of rows and blocks are 2⁻¹⁶ as large.
// Nothing bright is left out. Densities add up to 1 but for the sum's rounding.
TEST(PixelDistribution, DensityFollowsBrightnessAndAddsUpToOne) {
    const PixelDistribution places = distribution_of(kWidth, kHeight, magnitudes());
    const std::vector<double> wanted = expected();
    std::vector<double> of_block(std::size_t{kWidth / 8} * (kHeight / 4));
    const auto block_of = [](int x, int y) { return index_of(x / 8, y / 4, kWidth / 8); };
    const auto for_each_pixel = [&](const auto& visit) {
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                visit(x, y, wanted[index_of(x, y)]);
            }
        }
    };
    for_each_pixel([&](int x, int y, double probability) { of_block[block_of(x, y)] += probability; });
    double sum = 0.0;
    for_each_pixel([&](int x, int y, double probability) {
        const double found = places.pdf(centre(x, y)) / (kWidth * kHeight);
        EXPECT_NEAR(found, probability, 34 * 0x1p-16 * of_block[block_of(x, y)]) << x << ' ' << y;
        EXPECT_EQ(found > 0.0, probability > 0.0) << x << ' ' << y;
        sum += found;
    });
    EXPECT_NEAR(sum, 1.0, kWidth * kHeight * 0x1p-53);
}

// The square that numbers come from is cut into rectangles, one for each cell, as high as its row of blocks is
// probable: of a grid of N × N points the fraction in one of h × w is h w to (h + w) / N + 1 / N². Each draw is told
// the density that stands where it falls.
TEST(PixelDistribution, DrawsWithItsDensity) {
    const PixelDistribution places = distribution_of(kWidth, kHeight, magnitudes());
    constexpr int kSteps = 2000;
    std::vector<double> found(std::size_t{kWidth} * kHeight);
    for (int i = 0; i < kSteps; ++i) {
        for (int k = 0; k < kSteps; ++k) {
            const PixelDistribution::Draw draw = places.draw({(i + 0.5) / kSteps, (k + 0.5) / kSteps});
            ASSERT_GT(draw.pdf, 0.0);
            ASSERT_DOUBLE_EQ(places.pdf(draw.at), draw.pdf);
            found[static_cast<std::size_t>(draw.at.y * kHeight) * kWidth +
                  static_cast<std::size_t>(draw.at.x * kWidth)] += 1.0 / kSteps / kSteps;
        }
    }
    std::vector<double> of_row(kHeight / 4);
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            of_row[static_cast<std::size_t>(y / 4)] += places.pdf(centre(x, y)) / (kWidth * kHeight);
        }
    }
    for (int y = 0; y < kHeight; ++y) {
        const double high = of_row[static_cast<std::size_t>(y / 4)];
        for (int x = 0; x < kWidth; ++x) {
            const double probability = places.pdf(centre(x, y)) / (kWidth * kHeight);
            const double wide = high > 0.0 ? probability / high : 0.0;
            const double cut_off = (high + wide + 1.0 / kSteps) / kSteps;
            EXPECT_NEAR(found[index_of(x, y)], probability, cut_off) << x << ' ' << y;
        }
    }
}

// Of 4096 × 2048 pixels a cell has 2 × 2: of a bright one alone among dark ones, the root of whose mean square is half
// of it, half of the cell's draws meet it in either direction; what weighs next to nothing keeps a density.
TEST(PixelDistribution, ABrightPixelOfALargePictureHasACell) {
    constexpr int kWide = 4096;
    constexpr int kHigh = 2048;
    std::vector<double> values(std::size_t{kWide} * kHigh, 1e-6);
    values[index_of(1234, 700, kWide)] = 1e6;
    const PixelDistribution places = distribution_of(kWide, kHigh, values);
    const double bright = 4 * 0.5e6;
    const double all = bright + 1e-6 * kWide * kHigh;
    const double probability = 4.0 * places.pdf(centre(1234, 700, kWide, kHigh)) / kWide / kHigh;
    EXPECT_NEAR(probability, bright / all, 34 * 0x1p-16);
    EXPECT_GT(places.pdf(centre(1, 1, kWide, kHigh)), 0.0);
    const PixelDistribution::Draw draw = places.draw({0.5, 0.5});
    EXPECT_NEAR(draw.at.x * kWide, 1235, 1.0);
    EXPECT_NEAR(draw.at.y * kHigh, 701, 1.0);
}

// The ends of the numbers, and pictures of a single pixel, row or column.
TEST(PixelDistribution, EndsAreInside) {
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 40), std::pair(40, 1), std::pair(33, 17)}) {
        const PixelDistribution places =
            distribution_of(width, height, std::vector<double>(index_of(0, height, width), 0.3));
        for (const double u : {0.0, 0x1p-53, 0.5, 1.0 - 0x1p-53}) {
            for (const double v : {0.0, 0x1p-53, 0.5, 1.0 - 0x1p-53}) {
                const PixelDistribution::Draw draw = places.draw({u, v});
                EXPECT_GE(std::min(draw.at.x, draw.at.y), 0.0);
                EXPECT_LE(std::max(draw.at.x, draw.at.y), 1.0);
                EXPECT_NEAR(draw.pdf, 1.0, 33 * 0x1p-16 * 32);  // of a cell, which has 2¹⁶ / 32 chances
            }
        }
    }
}

}  // namespace lensproof::scene::pixel_distribution_test
