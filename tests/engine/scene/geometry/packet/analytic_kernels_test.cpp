#include "engine/scene/geometry/packet/analytic_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
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

/// Every fourth from far away.
RayColumns some_rays(std::mt19937_64& random, std::size_t size) {
    RayColumns rays;
    rays.size = size;
    for (std::size_t i = 0; i < size; ++i) {
        const Vec3d direction = random_direction(random);
        const Vec3d origin{uniform(random, -9, 9), uniform(random, -9, 9), uniform(random, -9, 9)};
        const double back = size % 2 == 0 && i % 4 == 0 ? 1e4 : 0.0;
        rays.set(i, {.origin = origin - back * direction,
                     .direction = direction,
                     .from = uniform(random, 0, 2),
                     .to = i % 3 == 0 ? 8.0 : 1e30});
    }
    return rays;
}

Stretch<double> ray_of(const RayColumns& rays, std::size_t i) {
    return {.origin = {rays.origin[0][i], rays.origin[1][i], rays.origin[2][i]},
            .direction = {rays.direction[0][i], rays.direction[1][i], rays.direction[2][i]},
            .from = rays.from[i],
            .to = rays.to[i]};
}

/// The first of `count`, one after the other, by the scalar meeting `meet_one(index, ray)`.
template <class MeetOne>
FirstMeeting first_of(std::size_t count, Stretch<double> ray, const MeetOne& meet_one) {
    FirstMeeting first;
    for (std::size_t i = 0; i < count; ++i) {
        if (const auto [is_met, meeting] = meet_one(i, ray); is_met) {
            ray.to = meeting.at;
            first = {.meeting = meeting, .which = static_cast<int>(i)};
        }
    }
    return first;
}

void expect_same(const FirstMeeting& found, const FirstMeeting& expected, SimdLevel level) {
    ASSERT_EQ(found.which, expected.which) << simd_name(level);
    if (expected.is_one()) {
        ASSERT_EQ(found.meeting.at, expected.meeting.at) << simd_name(level);
        ASSERT_EQ(found.meeting.b1, expected.meeting.b1) << simd_name(level);
        ASSERT_EQ(found.meeting.b2, expected.meeting.b2) << simd_name(level);
    }
}

// Each lane is computed as a single ray is, so every width of packets has its bits; whatever the number of rays, and
// of objects that are equally far the first.
TEST(AnalyticKernels, EveryLevelMeetsWhatSingleRaysDo) {
    std::mt19937_64 random(1);
    const std::vector<AnalyticObject> objects = some_objects(random);
    const auto meet_one = [&](std::size_t i, const Stretch<double>& ray) { return meet(objects[i], ray); };
    std::vector<int> met_by_kind(2);
    for (std::size_t round = 0; round < 400; ++round) {
        const RayColumns rays = some_rays(random, 1 + round % RayColumns::kMost);
        for (const SimdLevel level : available_simd_levels()) {
            MeetingColumns found;
            MeetingColumns any;
            analytic_kernels(level).first.objects(objects, rays, found);
            analytic_kernels(level).any.objects(objects, rays, any);
            for (std::size_t i = 0; i < rays.size; ++i) {
                const FirstMeeting expected = first_of(objects.size(), ray_of(rays, i), meet_one);
                expect_same(found.first(i), expected, level);
                ASSERT_EQ(any.is_any(i), expected.is_one()) << simd_name(level);
                ASSERT_LT(expected.which, 12);
                met_by_kind[static_cast<std::size_t>(expected.which + 2) % 2] += expected.is_one() ? 1 : 0;
            }
        }
    }
    EXPECT_GT(met_by_kind[0], 200);
    EXPECT_GT(met_by_kind[1], 200);
}

/// Single ones and pairs in a plane, twice the same.
FewTriangles some_triangles(std::mt19937_64& random) {
    FewTriangles few{.reach_mm = 20.0};
    const auto grid_point = [&] {  // that floats are exact at
        const auto coordinate = [&] { return static_cast<double>(static_cast<int>(random() % 17) - 8); };
        return Vec3d{coordinate(), coordinate(), coordinate()};
    };
    std::vector<TriangleSides> sides;
    while (sides.size() < 15) {
        const Vec3d a = grid_point();
        const Vec3d along = 0.5 * grid_point();
        const Vec3d across = 0.5 * grid_point();
        if (length(cross(along, across)) < 1.0) {
            continue;
        }
        sides.push_back({a, along, across});
        if (sides.size() % 3 == 0) {
            sides.push_back({a + along, across - along, across});
        }
    }
    for (int time = 0; time < 2; ++time) {
        for (const TriangleSides& triangle : sides) {
            few.add(triangle);
        }
    }
    return few;
}

// Of triangles, too, for many rays and for one; a block's lanes of zeros are met by nothing.
TEST(AnalyticKernels, EveryLevelMeetsTheFirstTriangle) {
    std::mt19937_64 random(2);
    const FewTriangles few = some_triangles(random);
    ASSERT_EQ(few.blocks.size(), 4);
    ASSERT_LT(few.planes.size(), few.triangles.size());
    const auto plane_of = [&](std::size_t i) {
        return std::ranges::find_if(few.planes, [&](const TrianglePlane& plane) { return i < plane.end; });
    };
    const auto meet_one = [&](std::size_t i, const Stretch<double>& ray) {
        const PlaneMeeting<double> meeting = meet_plane(plane_of(i)->height, ray);
        const Vec3d point = ray.origin + meeting.at * ray.direction;
        const std::array<double, 3> coordinates{point.x, point.y, point.z};
        const FlatTriangle& triangle = few.triangles[i];
        return meet_in_plane(triangle.in_plane,
                             grown_rim(triangle.b1_slope, triangle.b2_slope, few.reach_from(ray.origin)), meeting,
                             Vec2d{coordinates[plane_of(i)->across[0]], coordinates[plane_of(i)->across[1]]});
    };
    int met = 0;
    for (std::size_t round = 0; round < 400; ++round) {
        const RayColumns rays = some_rays(random, 1 + round % RayColumns::kMost);
        for (const SimdLevel level : available_simd_levels()) {
            MeetingColumns found;
            MeetingColumns any;
            analytic_kernels(level).first.triangles(few, rays, found);
            analytic_kernels(level).any.triangles(few, rays, any);
            for (std::size_t i = 0; i < rays.size; ++i) {
                const FirstMeeting expected = first_of(few.triangles.size(), ray_of(rays, i), meet_one);
                ASSERT_LT(expected.which, static_cast<int>(few.triangles.size() / 2));
                met += expected.is_one() ? 1 : 0;
                expect_same(found.first(i), expected, level);
                ASSERT_EQ(any.is_any(i), expected.is_one()) << simd_name(level);
                expect_same(analytic_kernels(level).meet_first_triangle(few, ray_of(rays, i)), expected, level);
            }
        }
    }
    EXPECT_GT(met, 1000);  // some 1300 by each of the levels that the build has
}

// At any point of a plane, however it leans, the coordinates say where between the vertices it lies. A gradient along
// two coordinates is no more than √3 times as steep as one in the plane, and each number has some ten roundings.
TEST(FewTriangles, CountByTwoCoordinatesOfThePoint) {
    std::mt19937_64 random(3);
    std::array<int, 3> by_dropped{};
    for (int i = 0; i < 1000; ++i) {
        FewTriangles few{.reach_mm = 10.0};
        const TriangleSides sides{3.0 * random_direction(random), 2.0 * random_direction(random),
                                  2.0 * random_direction(random)};
        const double area2 = length(cross(sides.to_second, sides.to_third));
        if (area2 < 0.5) {
            continue;
        }
        few.add(sides);
        const double b1 = uniform(random, -1, 2);
        const double b2 = uniform(random, -1, 2);
        const Vec3d point = sides.first + b1 * sides.to_second + b2 * sides.to_third;
        const std::array<double, 3> coordinates{point.x, point.y, point.z};
        const auto [u, v] = few.planes.front().across;
        const auto& [of_b1, of_b2] = few.triangles.front().in_plane;
        const double most_slope = std::sqrt(3.0) * 2.0 / area2;
        const double tolerance = 10.0 * 0x1p-53 * few.reach_mm * most_slope;
        EXPECT_NEAR(of_b1.at({coordinates[u], coordinates[v]}), b1, tolerance);
        EXPECT_NEAR(of_b2.at({coordinates[u], coordinates[v]}), b2, tolerance);
        EXPECT_LE(few.triangles.front().b1_slope, most_slope * (1.0 + 1e-12));
        EXPECT_LE(few.triangles.front().b2_slope, most_slope * (1.0 + 1e-12));
        ++by_dropped[3 - u - v];
    }
    EXPECT_GT(*std::ranges::min_element(by_dropped), 200);
}

// What shares a plane is met there: beside it, and from a plane that stands off by more than rounding, not.
TEST(FewTriangles, SharePlanesThatAreTheSameToRounding) {
    FewTriangles few{.reach_mm = 10.0};
    const TriangleSides first{{0, 0, 5}, {1, 0, 0}, {0, 1, 0}};
    few.add(first);
    few.add({{3, 3, 5}, {0, 2, 0}, {2, 0, 0}});  // from the other side
    few.add({{3, 3, 5.0 + 1e-13}, {0, 2, 0}, {2, 0, 0}});
    few.add({{0, 0, 5}, {1, 0, 0}, {0, 1, 1e-13}});
    few.add(first);  // one that is not the last before it is not found again
    std::vector<std::size_t> ends;
    std::ranges::transform(few.planes, std::back_inserter(ends), &TrianglePlane::end);
    EXPECT_EQ(ends, (std::vector<std::size_t>{2, 3, 4, 5}));
}

}  // namespace lensproof::scene::analytic_kernels_test
