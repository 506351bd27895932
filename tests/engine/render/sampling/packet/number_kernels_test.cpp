#include "engine/render/sampling/packet/number_kernels.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace lensproof::render::number_kernels_test {

// Every width of packets says what the samplers say one by one, to the bit, whatever their number.
TEST(NumberKernels, EveryLevelSaysWhatTheSamplersSay) {
    std::mt19937_64 random(1);
    for (int size = 0; size <= NumberColumns::kMost; ++size) {
        std::vector<PathSampler> samplers;
        NumberColumns columns;
        columns.for_surfaces = size / 2;
        for (int i = 0; i < size; ++i) {
            PathSampler sampler(random(), static_cast<std::uint32_t>(random()), static_cast<std::uint32_t>(random()));
            sampler.skip(static_cast<std::uint64_t>(i));
            columns.add(sampler, 1 + static_cast<std::uint64_t>(i) % 2);
            sampler.skip(static_cast<std::uint64_t>(i) % 2);
            samplers.push_back(sampler);
        }
        for (const SimdLevel level : available_simd_levels()) {
            NumberColumns found = columns;
            number_kernels(level).draw(found);
            for (std::size_t i = 0; i < samplers.size(); ++i) {
                const auto expected = samplers[i].peek();
                const bool is_for_surface = static_cast<int>(i) < found.for_surfaces;
                const int numbers = is_for_surface ? NumberColumns::kNumbers : NumberColumns::kForLights;
                for (std::size_t k = 0; k < static_cast<std::size_t>(numbers); ++k) {
                    EXPECT_EQ(found.number[k][i], expected[k]) << simd_name(level);
                }
                if (is_for_surface) {
                    EXPECT_EQ(found.matt_direction(i), cosine_direction(expected[1], expected[2])) << simd_name(level);
                }
            }
        }
    }
}

}  // namespace lensproof::render::number_kernels_test
