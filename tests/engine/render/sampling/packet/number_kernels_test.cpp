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
            columns.add(sampler, 1 + static_cast<std::uint64_t>(i) % 2);
            sampler.skip(static_cast<std::uint64_t>(i) % 2);
            samplers.push_back(sampler);
        }
        for (const SimdLevel level : available_simd_levels()) {
            NumberColumns found = columns;
            number_kernels(level).draw(found);
            for (int i = 0; i < size; ++i) {
                EXPECT_EQ(found.numbers(i), samplers[static_cast<std::size_t>(i)].peek()) << simd_name(level);
            }
        }
    }
}

}  // namespace lensproof::render::number_kernels_test
