#include "engine/render/sampling/sampler.h"

#include <gtest/gtest.h>

#include <array>
#include <utility>

namespace lensproof::render::sampler_test {

// Sobol's sequence is a (0,1)-sequence in each dimension: 2^k points put exactly one into each of 2^k equal intervals,
// and Owen's scramble keeps that.
TEST(Sampler, EveryDimensionIsStratified) {
    constexpr std::uint32_t kPoints = 256;
    const PixelSampler sampler(42, 1234);
    std::array<std::array<int, kPoints>, PixelSampler::kDimensions> hits{};
    for (std::uint32_t i = 0; i < kPoints; ++i) {
        const auto point = sampler.point(i);
        for (int d = 0; d < PixelSampler::kDimensions; ++d) {
            ++hits[d][static_cast<std::size_t>(point[d] * kPoints)];
        }
    }
    for (const auto& dimension : hits) {
        for (const int count : dimension) {
            EXPECT_EQ(count, 1);
        }
    }
}

// The first two dimensions form a (0,2)-sequence: 256 points put one into each of 16 × 16 cells.
TEST(Sampler, ThePixelIsStratifiedInBothDirections) {
    const PixelSampler sampler(7, 99);
    std::array<int, 256> hits{};
    for (std::uint32_t i = 0; i < 256; ++i) {
        const auto point = sampler.point(i);
        ++hits[static_cast<std::size_t>(point[0] * 16) * 16 + static_cast<std::size_t>(point[1] * 16)];
    }
    for (const int count : hits) {
        EXPECT_EQ(count, 1);
    }
}

// Columns hold what single points are, to the bit: from any sample on, over the ends of the blocks that they are made
// in, and of one point alone.
TEST(Sampler, ColumnsHoldTheSinglePoints) {
    constexpr std::uint32_t kMost = 600;
    std::array<std::array<double, kMost>, PixelSampler::kDimensions> columns{};
    const std::array<double*, PixelSampler::kDimensions> to{columns[0].data(), columns[1].data(), columns[2].data(),
                                                            columns[3].data(), columns[4].data()};
    const PixelSampler sampler(11, 4321);
    for (const auto& [first, count] :
         {std::pair{0U, 64U}, {3U, 1U}, {255U, 2U}, {256U, 256U}, {1000U, kMost}, {0x12345678U, 300U}, {7U, 0U}}) {
        sampler.points(first, count, to);
        for (std::uint32_t i = 0; i < count; ++i) {
            const auto point = sampler.point(first + i);
            for (int d = 0; d < PixelSampler::kDimensions; ++d) {
                EXPECT_EQ(columns[d][i], point[d]) << "sample " << first + i << ", dimension " << d;
            }
        }
    }
}

TEST(Sampler, PixelsAndSeedsDiffer) {
    EXPECT_EQ(PixelSampler(0, 5).point(3), PixelSampler(0, 5).point(3));
    EXPECT_NE(PixelSampler(0, 5).point(3), PixelSampler(0, 6).point(3));
    EXPECT_NE(PixelSampler(0, 5).point(3), PixelSampler(1, 5).point(3));
}

// The mean of a scrambled point is 1/2 in every dimension over the pixels: standard error 1 / √(12 · 10000) = 0.0029.
TEST(Sampler, IsUnbiasedOverPixels) {
    std::array<double, PixelSampler::kDimensions> sum{};
    for (std::uint32_t pixel = 0; pixel < 10000; ++pixel) {
        const auto point = PixelSampler(3, pixel).point(5);
        for (int d = 0; d < PixelSampler::kDimensions; ++d) {
            sum[d] += point[d] / 10000.0;
        }
    }
    for (const double mean : sum) {
        EXPECT_NEAR(mean, 0.5, 4 * 0.0029);
    }
}

}  // namespace lensproof::render::sampler_test
