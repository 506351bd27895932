#include "engine/scene/geometry/packet/analytic_kernels.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/engine/scene/scene_shapes.h"

namespace lensproof::scene::analytic_kernels_test {

using test::at;
using test::random_direction;
using test::scaled;
using test::uniform;

std::vector<AnalyticObject> some_objects(std::mt19937_64& random) {
    std::vector<AnalyticObject> objects;
    for (int i = 0; i < 12; ++i) {
        const AffineMap map = at({uniform(random, -9, 9), uniform(random, -9, 9), uniform(random, -9, 9)},
                                 product(about_x(uniform(random, 0, 360)), scaled(0.5, 1.0, uniform(random, 1, 3))));
        AnalyticObject object{.to_local = *inverse(map)};
        if (i % 2 == 0) {
            object.radius_mm = uniform(random, 0.5, 3.0);
        } else {
            object.half_mm = {uniform(random, 0.5, 4.0), uniform(random, 0.5, 4.0)};
        }
        objects.push_back(object);
    }
    objects.push_back(objects.front());  // two that are equally far wherever they are met
    objects.push_back(objects[1]);
    return objects;
}

/// What the scalar meetings say, one object after the other.
RayColumns one_by_one(const std::vector<AnalyticObject>& objects, const RayColumns& given) {
    RayColumns rays = given;
    for (std::size_t i = 0; i < rays.size; ++i) {
        for (std::size_t k = 0; k < objects.size(); ++k) {
            const auto [is_met, meeting] =
                meet(objects[k], Stretch<double>{{rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]},
                                                 {rays.direction_x[i], rays.direction_y[i], rays.direction_z[i]},
                                                 rays.from[i],
                                                 rays.to[i]});
            if (is_met) {
                rays.object[i] = static_cast<double>(k);
                rays.to[i] = meeting.at;
                rays.b1[i] = meeting.b1;
                rays.b2[i] = meeting.b2;
            }
        }
    }
    return rays;
}

// Each lane is computed as a single ray is, so every width of packets has its bits; whatever the number of rays, and
// of objects that are equally far the first.
TEST(AnalyticKernels, EveryLevelMeetsWhatSingleRaysDo) {
    std::mt19937_64 random(1);
    const std::vector<AnalyticObject> objects = some_objects(random);
    std::vector<int> met_by_kind(2);
    for (int round = 0; round < 400; ++round) {
        RayColumns rays;
        rays.size = 1 + static_cast<std::size_t>(round) % RayColumns::kMost;
        for (std::size_t i = 0; i < rays.size; ++i) {
            rays.set(i, {.origin = {uniform(random, -9, 9), uniform(random, -9, 9), uniform(random, -9, 9)},
                         .direction = random_direction(random),
                         .from = uniform(random, 0, 2),
                         .to = i % 3 == 0 ? 8.0 : 1e30});
        }
        const RayColumns expected = one_by_one(objects, rays);
        for (std::size_t i = 0; i < rays.size; ++i) {
            if (expected.object[i] >= 0.0) {
                ++met_by_kind[static_cast<std::size_t>(expected.object[i]) % 2];
            }
        }
        for (const SimdLevel level : available_simd_levels()) {
            RayColumns found = rays;
            analytic_kernels(level).meet_nearest(objects, found);
            for (std::size_t i = 0; i < rays.size; ++i) {
                ASSERT_EQ(found.object[i], expected.object[i]) << simd_name(level);
                if (found.object[i] < 0.0) {
                    continue;
                }
                ASSERT_LT(found.object[i], 12.0);
                ASSERT_EQ(found.to[i], expected.to[i]) << simd_name(level);
                ASSERT_EQ(found.b1[i], expected.b1[i]) << simd_name(level);
                ASSERT_EQ(found.b2[i], expected.b2[i]) << simd_name(level);
            }
        }
    }
    EXPECT_GT(met_by_kind[0], 200);
    EXPECT_GT(met_by_kind[1], 200);
}

/// What the scalar functions say of one triangle after the other.
TriangleMeeting one_by_one(const std::vector<TriangleBlock>& blocks, const Stretch<double>& ray, double reach_mm) {
    const auto function = [](const TriangleBlock::Function& f, std::size_t lane) {
        return LaneFunction<double>{{f.x[lane], f.y[lane], f.z[lane]}, f.at_origin[lane]};
    };
    TriangleMeeting first;
    Stretch<double> rest = ray;
    for (std::size_t i = 0; i < blocks.size() * TriangleBlock::kLanes; ++i) {
        const TriangleBlock& block = blocks[i / TriangleBlock::kLanes];
        const std::size_t lane = i % TriangleBlock::kLanes;
        const auto [is_met, meeting] =
            meet_triangles(function(block.height, lane), function(block.b1, lane), function(block.b2, lane),
                           block.b1_slope[lane], block.b2_slope[lane], reach_mm, rest);
        if (is_met) {
            rest.to = meeting.at;
            first = {.meeting = meeting, .triangle = static_cast<int>(i)};
        }
    }
    return first;
}

// Of triangles, too, some of which stand there twice; lanes of zeros are met by nothing.
TEST(AnalyticKernels, EveryLevelMeetsTheFirstTriangle) {
    std::mt19937_64 random(2);
    std::vector<TriangleBlock> blocks(4);
    const auto set = [](TriangleBlock::Function& function, std::size_t lane, const Vec3d& gradient, double at_origin) {
        function.x[lane] = gradient.x;
        function.y[lane] = gradient.y;
        function.z[lane] = gradient.z;
        function.at_origin[lane] = at_origin;
    };
    for (std::size_t i = 0; i < 3 * TriangleBlock::kLanes; ++i) {
        TriangleBlock& block = blocks[i / TriangleBlock::kLanes];
        const std::size_t lane = i % TriangleBlock::kLanes;
        set(block.height, lane, random_direction(random), uniform(random, -3, 3));
        set(block.b1, lane, uniform(random, 0.1, 0.3) * random_direction(random), uniform(random, 0, 0.4));
        set(block.b2, lane, uniform(random, 0.1, 0.3) * random_direction(random), uniform(random, 0, 0.4));
        block.b1_slope[lane] = block.b2_slope[lane] = 0.3;
    }
    blocks[2] = blocks[0];
    int met = 0;
    for (int i = 0; i < 10000; ++i) {
        const Stretch<double> ray{.origin = {uniform(random, -9, 9), uniform(random, -9, 9), uniform(random, -9, 9)},
                                  .direction = random_direction(random),
                                  .from = uniform(random, 0, 2),
                                  .to = i % 3 == 0 ? 8.0 : 1e30};
        const TriangleMeeting expected = one_by_one(blocks, ray, 9.0);
        met += expected.triangle >= 0 ? 1 : 0;
        ASSERT_LT(expected.triangle, 16);
        for (const SimdLevel level : available_simd_levels()) {
            const TriangleMeeting found = analytic_kernels(level).meet_first_triangle(blocks, ray, 9.0);
            ASSERT_EQ(found.triangle, expected.triangle) << simd_name(level);
            if (expected.triangle >= 0) {
                ASSERT_EQ(found.meeting.at, expected.meeting.at) << simd_name(level);
                ASSERT_EQ(found.meeting.b1, expected.meeting.b1) << simd_name(level);
                ASSERT_EQ(found.meeting.b2, expected.meeting.b2) << simd_name(level);
            }
        }
    }
    EXPECT_GT(met, 2000);
}

}  // namespace lensproof::scene::analytic_kernels_test
