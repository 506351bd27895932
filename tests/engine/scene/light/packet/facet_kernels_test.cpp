#include "engine/scene/light/packet/facet_kernels.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "engine/scene/light/area_light.h"
#include "tests/engine/scene/scene_shapes.h"

namespace lensproof::scene::facet_kernels_test {

using test::at;
using test::box_mesh;
using test::random_direction;
using test::scaled;
using test::uniform;

ShiningFacets random_facets(std::mt19937_64& random, std::size_t count, bool is_quad) {
    ShiningFacets facets{.is_quad = is_quad, .areas_to_mm2 = {0.0}, .pdf_per_mm2 = uniform(random, 1e-6, 1.0)};
    for (std::size_t i = 0; i < count; ++i) {
        facets.first.push_back(100.0 * random_direction(random));
        facets.to_second.push_back(20.0 * random_direction(random));
        facets.to_third.push_back(20.0 * random_direction(random));
        facets.normal.push_back(random_direction(random));
        facets.error_mm.push_back(uniform(random, 1e-13, 1e-12));
        facets.areas_to_mm2.push_back(facets.areas_to_mm2.back() + uniform(random, 0.1, 10.0));
    }
    return facets;
}

void expect_same(const ShiningView<double>& found, const ShiningView<double>& expected, SimdLevel level) {
    EXPECT_EQ(found.direction, expected.direction) << simd_name(level);
    EXPECT_EQ(found.end, expected.end) << simd_name(level);
    EXPECT_EQ(found.cosine, expected.cosine) << simd_name(level);
    EXPECT_EQ(found.pdf, expected.pdf) << simd_name(level);
    EXPECT_EQ(found.per_pdf, expected.per_pdf) << simd_name(level);
}

// Every width of packets sees what a point sees by itself, to the bit, whatever their number.
TEST(FacetKernels, EveryLevelSeesWhatAPointSees) {
    std::mt19937_64 random(3);
    for (std::size_t size = 0; size <= ViewColumns::kMost; ++size) {
        const bool is_quad = size % 3 == 0;
        const ShiningFacets facets = random_facets(random, is_quad ? 1 : 1 + size % kFewTriangles, is_quad);
        ViewColumns columns;
        for (std::size_t i = 0; i < size; ++i) {
            columns.add(100.0 * random_direction(random), {uniform(random, 0.0, 1.0), uniform(random, 0.0, 1.0)});
        }
        for (const SimdLevel level : available_simd_levels()) {
            facet_kernels(level).see(facets, columns);
            for (std::size_t i = 0; i < size; ++i) {
                expect_same(columns.view(i),
                            seen_from<double>(columns.from.at(i), point_on(facets, columns.u1[i], columns.u2[i])),
                            level);
            }
        }
    }
}

/// Of an even lamp, with what it was drawn ahead and without.
void expect_sample_ahead(const SceneGeometry& scene, std::mt19937_64& random) {
    const auto grid = spectral::spectral_grid(400.0, 700.0, 4);
    const AreaLight light{.object = 0, .radiance = spectral::constant_spectrum(2.0, grid), .is_two_sided = true};
    const ShiningSurface surface(scene, light);
    std::vector<Vec3d> points;
    std::vector<LightNumbers> numbers(100);
    for (LightNumbers& one : numbers) {
        points.push_back(50.0 * random_direction(random));
        one.of_point = {uniform(random, 0.0, 1.0), uniform(random, 0.0, 1.0)};
    }
    surface.draw_ahead(points, numbers);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        ASSERT_TRUE(std::holds_alternative<SurfaceDraw>(numbers[i].ahead));
        const auto ahead = surface.sample(light, points[i], grid.path(0), numbers[i]);
        const auto alone = surface.sample(light, points[i], grid.path(0), {.of_point = numbers[i].of_point});
        ASSERT_TRUE(ahead && alone);
        EXPECT_EQ(ahead->direction, alone->direction);
        EXPECT_EQ(ahead->end, alone->end);
        EXPECT_EQ(ahead->value, alone->value);
        EXPECT_EQ(ahead->pdf, alone->pdf);
        EXPECT_EQ(ahead->leaving_per_sample, alone->leaving_per_sample);
    }
}

// A lamp that is a quad, or a mesh of few triangles, gives a point the same sample, to the bit, whether it was drawn
// ahead or not.
TEST(FacetKernels, WhatIsDrawnAheadIsWhatIsDrawnAlone) {
    std::mt19937_64 random(4);
    expect_sample_ahead(test::scene_of(Quad{4.0, 2.0}, at({1, 2, 3}, product(about_x(30.0), scaled(3, 0.5, 1)))),
                        random);
    expect_sample_ahead(test::scene_of(box_mesh(1.5F), at({3, 2, 1}, about_y(12.0))), random);
}

// One of many triangles, or a sphere, is drawn by each point alone.
TEST(FacetKernels, WhatIsRoundIsNotDrawnAhead) {
    const auto grid = spectral::spectral_grid(400.0, 700.0, 4);
    const AreaLight light{.object = 0, .radiance = spectral::constant_spectrum(2.0, grid)};
    for (const Shape& shape : {Shape(Sphere{1.0}), Shape(test::icosphere(1.0, 1))}) {
        const SceneGeometry scene = test::scene_of(shape);
        std::vector<LightNumbers> numbers = {{.of_point = {0.5, 0.5}}};
        ShiningSurface(scene, light).draw_ahead(std::vector<Vec3d>{{3, 0, 0}}, numbers);
        EXPECT_TRUE(std::holds_alternative<std::monostate>(numbers.front().ahead));
    }
}

}  // namespace lensproof::scene::facet_kernels_test
