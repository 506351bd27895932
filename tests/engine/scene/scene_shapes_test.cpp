#include "tests/engine/scene/scene_shapes.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "engine/scene/geometry/shapes.h"
#include "tests/complaint.h"

namespace lensproof::scene::scene_shapes_test {

using test::at;
using test::box_mesh;
using test::scaled;
using test::scene_of;

TEST(SceneShapes, UnusableMeshesAreRefusedByName) {
    const TriangleMesh good = box_mesh(1.0F);
    const auto refusal = [](const TriangleMesh& mesh) { return complaint_about([&] { scene_of(mesh); }); };
    TriangleMesh mesh = good;
    mesh.positions[5].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(refusal(mesh).find("box: vertex 5 is (1, nan, 1)"), std::string::npos) << refusal(mesh);
    mesh = good;
    mesh.positions[2].z = std::numeric_limits<float>::infinity();
    EXPECT_NE(refusal(mesh).find("box: vertex 2"), std::string::npos) << refusal(mesh);
    mesh = good;
    mesh.triangles[3][1] = 8;
    EXPECT_NE(refusal(mesh).find("box: triangle 3 has the vertex 8"), std::string::npos) << refusal(mesh);
    mesh = good;
    mesh.normals.resize(3);
    EXPECT_NE(refusal(mesh).find("3 normals for 8 vertices"), std::string::npos) << refusal(mesh);
    mesh = good;
    mesh.triangles = {{0, 1, 1}};
    EXPECT_NE(refusal(mesh).find("no triangle that has an area"), std::string::npos) << refusal(mesh);
    EXPECT_NE(complaint_about([] { scene_of(Sphere{0.0}); }).find("no size"), std::string::npos);
    EXPECT_NE(complaint_about([] { scene_of(Sphere{1.0}, at({}, scaled(1, 1, 0))); }).find("flattens"),
              std::string::npos);
    EXPECT_NE(complaint_about([] { scene_of(Sphere{1.0}, at({2e12, 0, 0})); }).find("as far out"), std::string::npos);
}

TEST(SceneShapes, DegenerateTrianglesAreDroppedAndCounted) {
    TriangleMesh mesh = box_mesh(1.0F);
    mesh.triangles.push_back({4, 4, 5});
    mesh.triangles.push_back({1, 2, 1});
    const SceneGeometry scene = scene_of(mesh);
    ASSERT_EQ(scene.remarks().size(), 1U);
    EXPECT_EQ(scene.remarks()[0], "box: 2 of 14 triangles have no area and are left out");
    EXPECT_EQ(std::get<TriangleMesh>(scene.shape(0)).triangles.size(), 12U);
}

}  // namespace lensproof::scene::scene_shapes_test
