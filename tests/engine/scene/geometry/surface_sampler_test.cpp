#include "engine/scene/geometry/surface_sampler.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "tests/engine/scene/scene_shapes.h"

namespace lensproof::scene::surface_sampler_test {

using test::at;
using test::box_mesh;
using test::icosphere;
using test::scaled;

constexpr double kPi = std::numbers::pi;

/// ∫ f dA over the object, by drawing points on a grid in the unit square: f over the pdf, on average.
template <class F>
double integral(const SurfaceSampler& sampler, int columns, int rows, const F& f) {
    double sum = 0.0;
    for (int i = 0; i < columns; ++i) {
        for (int k = 0; k < rows; ++k) {
            const SurfaceSample drawn = sampler.sample((i + 0.5) / columns, (k + 0.5) / rows);
            sum += f(drawn) / drawn.pdf_per_mm2;
        }
    }
    return sum / columns / rows;
}

// Areas that are known: of the whole, by the sampler's word and by what the pdfs add up to.
TEST(SurfaceSampler, AreasAreThoseOfTheWorld) {
    const SceneGeometry scene({Sphere{3.0}, Quad{4.0, 2.0}, box_mesh(1.5F)},
                              {{.shape = 0, .to_world = at({5, 0, 0}, scaled(2, 2, 2))},
                               {.shape = 1, .to_world = at({}, product(about_x(30.0), scaled(3, 0.5, 1)))},
                               {.shape = 2, .to_world = at({0, 9, 0}, scaled(1, 2, 3))},
                               {.shape = 2, .to_world = at({0, -9, 0}, about_y(12.0))}});
    const double expected[] = {4 * kPi * 36, 12.0, 2.0 * (3 * 6 + 6 * 9 + 9 * 3), 54.0};
    for (std::uint32_t object = 0; object < 4; ++object) {
        const SurfaceSampler sampler(scene, object);
        EXPECT_NEAR(sampler.area_mm2(), expected[object], 1e-12 * expected[object]);
        EXPECT_NEAR(integral(sampler, 16, 16, [](const auto&) { return 1.0; }), expected[object],
                    1e-12 * expected[object]);
    }
}

// The ellipsoid's area against the classical formula for one of revolution (prolate and oblate), and against the sum of
// the pdfs, which a midpoint rule of 400² nodes makes good to 1e-4.
TEST(SurfaceSampler, AnEllipsoidHasItsArea) {
    for (const double c : {0.25, 4.0}) {
        const SceneGeometry scene = test::scene_of(Sphere{1.0}, at({1, 2, 3}, product(about_x(40.0), scaled(1, 1, c))));
        const SurfaceSampler sampler(scene, 0);
        const double e = std::sqrt(c < 1.0 ? 1.0 - c * c : 1.0 - 1.0 / (c * c));
        const double expected =
            c < 1.0 ? 2 * kPi * (1 + (1 - e * e) / e * std::atanh(e)) : 2 * kPi * (1 + c / e * std::asin(e));
        EXPECT_NEAR(sampler.area_mm2(), expected, 1e-12 * expected);
        EXPECT_NEAR(integral(sampler, 400, 400, [](const auto&) { return 1.0; }), expected, 1e-4 * expected);
    }
}

// Archimedes: ∮ n dA = 0 and ∮ x·n dA = 3 V over a closed surface, whatever the map; V from the map's determinant.
TEST(SurfaceSampler, ClosedSurfacesEncloseTheirVolume) {
    const AffineMap map = at({4, -3, 2}, product(about_y(25.0), product(scaled(2, -1, 0.5), about_x(66.0))));
    const double stretched = 1.0;  // 2 · 1 · 0.5
    const SceneGeometry scene({Sphere{2.0}, box_mesh(1.0F)},
                              {{.shape = 0, .to_world = map}, {.shape = 1, .to_world = map}});
    const double volumes[] = {4.0 / 3.0 * kPi * 8.0 * stretched, 8.0 * stretched};
    for (std::uint32_t object = 0; object < 2; ++object) {
        const SurfaceSampler sampler(scene, object);
        const double volume =
            integral(sampler, 9000, 16, [](const SurfaceSample& s) { return dot(s.point, s.geometric_normal) / 3.0; });
        const double unbalanced =
            integral(sampler, 9000, 16, [](const SurfaceSample& s) { return s.geometric_normal.x; });
        // The box's planes are flat, so that only the fraction of points on each counts: 9000 strips over twelve
        // triangles up to 6 mm from the origin.
        EXPECT_NEAR(volume, volumes[object], 1e-3 * 6.0 * sampler.area_mm2() / 3.0);
        EXPECT_NEAR(unbalanced, 0.0, 1e-3 * sampler.area_mm2());
    }
}

// A ray aimed at a drawn point meets it: there, on that triangle, with that normal, uv and pdf.
TEST(SurfaceSampler, DrawnPointsAreWhatRaysMeet) {
    const AffineMap map = at({0, 0, 50}, product(about_x(30.0), scaled(1, 2, 0.7)));
    const SceneGeometry scene({Sphere{3.0}, Quad{4.0, 2.0}, icosphere(2.0, 2)},
                              {{.shape = 0, .to_world = map},
                               {.shape = 1, .to_world = at({20, 0, 50}, map.linear)},
                               {.shape = 2, .to_world = at({-20, 0, 50}, map.linear)}});
    std::mt19937_64 random(1);
    for (std::uint32_t object = 0; object < 3; ++object) {
        const SurfaceSampler sampler(scene, object);
        for (int i = 0; i < 1000; ++i) {
            const SurfaceSample drawn = sampler.sample(test::uniform(random, 0, 1), test::uniform(random, 0, 1));
            const Vec3d from = ray_origin(drawn.point, drawn.geometric_normal, drawn.error_mm, drawn.geometric_normal) +
                               5.0 * drawn.geometric_normal;
            const Vec3d to = -1.0 * drawn.geometric_normal;
            const auto hit = intersect(scene, from, to, 0.0, std::numeric_limits<double>::infinity());
            ASSERT_TRUE(hit);
            EXPECT_EQ(hit->object, object);
            EXPECT_EQ(hit->primitive, drawn.primitive);
            EXPECT_NEAR(length(hit->point - drawn.point), 0.0, 1e-12);
            EXPECT_NEAR(hit->uv.x, drawn.uv.x, 1e-12);
            EXPECT_NEAR(sampler.pdf_per_mm2(*hit) / drawn.pdf_per_mm2, 1.0, 1e-10);
        }
    }
}

}  // namespace lensproof::scene::surface_sampler_test
