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
        for (int i = 0; i < size; ++i) {
            PathSampler sampler(random(), static_cast<std::uint32_t>(random()), static_cast<std::uint32_t>(random()));
            sampler.skip(static_cast<std::uint64_t>(i));
            columns.add(sampler);
            samplers.push_back(sampler);
        }
        for (const SimdLevel level : available_simd_levels()) {
            NumberColumns found = columns;
            number_kernels(level).draw(found);
            for (std::size_t i = 0; i < samplers.size(); ++i) {
                PathSampler sampler = samplers[i];
                const auto next = sampler.next();
                const auto after = sampler.next();
                for (std::size_t k = 0; k < found.next.size(); ++k) {
                    EXPECT_EQ(found.next[k][i], next[k]) << simd_name(level);
                }
                for (std::size_t k = 0; k < found.after.size(); ++k) {
                    EXPECT_EQ(found.after[k][i], after[k]) << simd_name(level);
                }
                EXPECT_EQ(found.matt_direction(i), cosine_direction(next[1], next[2])) << simd_name(level);
            }
        }
    }
}

}  // namespace lensproof::render::number_kernels_test
