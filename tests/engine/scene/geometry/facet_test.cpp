// tests/engine/scene/geometry/facet_test.cpp — flat pieces that are found ahead, beside what a shape says of each
// point.
#include "engine/scene/geometry/facet.h"

#include <gtest/gtest.h>

#include "engine/scene/geometry/geometry_data.h"
#include "tests/engine/scene/scene_shapes.h"

namespace lensproof::scene::facet_test {

using test::at;
using test::box_mesh;
using test::icosphere;
using test::scaled;

const AffineMap kMap = at({300, -20, 1e4}, product(about_x(30.0), scaled(1, 2, 0.7)));

void expect_same(const SurfaceHit& ahead, const SurfaceHit& found) {
    EXPECT_LT(length(ahead.point - found.point), ahead.error_mm);
    EXPECT_GE(ahead.error_mm, found.error_mm);
    EXPECT_LT(length(ahead.geometric_normal - found.geometric_normal), 1e-14);
    EXPECT_LT(length(ahead.shading_normal - found.shading_normal), 1e-14);
    EXPECT_LT(length(ahead.tangent - found.tangent), 1e-14);
    EXPECT_NEAR(ahead.uv.x, found.uv.x, 1e-14);
    EXPECT_NEAR(ahead.uv.y, found.uv.y, 1e-14);
}

SurfaceHit hit_of(const Facet& facet, double a, double b) {
    SurfaceHit hit;
    facet.describe(a, b, hit);
    return hit;
}

TEST(Facet, IsWhatItsShapeSaysOfEachPoint) {
    const SceneGeometry scene({Quad{4.0, 2.0}, box_mesh(1.5F)},
                              {{.shape = 0, .to_world = kMap}, {.shape = 1, .to_world = kMap}});
    const auto& objects = scene.data().objects;
    const auto& quad = std::get<Quad>(*objects[0].shape);
    const auto& mesh = scene.data().mesh(1);
    ASSERT_EQ(objects[1].facets.size(), mesh.triangles.size());
    for (const double a : {0.0, 0.25, 0.7, 1.0}) {
        for (const double b : {0.0, 0.1, 0.3}) {
            expect_same(
                hit_of(objects[0].facets.front(), a, b),
                world_hit(objects[0].place, shape_point(quad, (a - 0.5) * quad.width_mm, (b - 0.5) * quad.height_mm)));
            for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
                expect_same(hit_of(objects[1].facets[i], a * (1.0 - b), b),
                            world_hit(objects[1].place, shape_point(mesh, i, a * (1.0 - b), b)));
            }
        }
    }
}

// What is shaded by vertices' normals, or stands in a scene more than once, has none.
TEST(Facet, IsOfFlatShapesThatStandOnce) {
    const SceneGeometry scene({icosphere(2.0, 1), box_mesh(1.0F)},
                              {{.shape = 0, .to_world = kMap}, {.shape = 1}, {.shape = 1, .to_world = kMap}});
    TriangleMesh shaded = icosphere(2.0, 1);
    shaded.normals = shaded.positions;
    const SceneGeometry other({shaded}, {{.shape = 0, .to_world = kMap}});
    EXPECT_FALSE(scene.data().objects[0].facets.empty());
    EXPECT_TRUE(scene.data().objects[1].facets.empty());
    EXPECT_TRUE(scene.data().objects[2].facets.empty());
    EXPECT_TRUE(other.data().objects[0].facets.empty());
}

}  // namespace lensproof::scene::facet_test
