#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "engine/base/write_file.h"
#include "engine/scene/geometry/mesh_file.h"
#include "engine/scene/geometry/mesh_material.h"
#include "tests/complaint.h"
#include "tests/engine/scene/gltf_cases.h"
#include "tests/test_folder.h"

namespace lensproof::scene::gltf_materials_test {

namespace fs = std::filesystem;
using test::data_uri;
using test::squares_gltf;

const std::string kTwo = R"("materials": [
{"name": "same", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.125, 1], "metallicFactor": 0.0, "roughnessFactor": 0.4,
 "baseColorTexture": {"index": 1, "extensions": {"KHR_texture_transform": {"offset": [0.25, 0.5], "scale": [2, 3], "rotation": 0.5}}},
 "metallicRoughnessTexture": {"index": 0}},
 "normalTexture": {"index": 0}, "alphaMode": "BLEND", "doubleSided": true},
{"name": "same", "emissiveFactor": [1, 0.5, 0],
 "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 40}, "KHR_materials_clearcoat": {},
 "KHR_materials_transmission": {"transmissionFactor": 0.75}, "KHR_materials_ior": {"ior": 1.33},
 "KHR_materials_volume": {"thicknessFactor": 0.1, "attenuationColor": [0.9, 0.8, 0.7], "attenuationDistance": 2.5}}}],
"textures": [{"source": 0}, {"source": 1, "sampler": 0}], "samplers": [{"wrapS": 33071, "wrapT": 33648}],
"images": [{"uri": "plain%20wood.png"}, {"uri": ")" +
                         data_uri("picture") + "\"}]";

TEST(GltfMaterials, AreReadAsTheFileSays) {
    const TestFolder folder;
    const fs::path file = folder.path() / "two.gltf";
    write_file(file, squares_gltf(kTwo));
    const GltfMaterials read = read_gltf_materials(file);
    ASSERT_EQ(read.materials.size(), 2U);
    const MeshMaterial& wood = read.materials[0];
    EXPECT_EQ(wood.base_colour, (Vec3d{0.5, 0.25, 0.125}));
    EXPECT_EQ(wood.metallic, 0.0);
    EXPECT_EQ(wood.roughness, 0.4);
    ASSERT_TRUE(wood.base_texture);
    EXPECT_EQ(wood.base_texture->wrap_u, MeshWrap::clamp);
    EXPECT_EQ(wood.base_texture->wrap_v, MeshWrap::mirror);
    EXPECT_EQ(read.pictures.at(wood.base_texture->picture).image, 1U);
    EXPECT_TRUE(read.pictures.at(wood.base_texture->picture).file.empty());
    EXPECT_EQ(embedded_picture(file, 1), "picture");
    EXPECT_FALSE(wood.metallic_roughness) << "it is laid out otherwise than the first";
    EXPECT_TRUE(wood.is_two_sided);
    const MeshMaterial& glass = read.materials[1];
    EXPECT_EQ(glass.metallic, 1.0);
    EXPECT_EQ(glass.emission, (Vec3d{40.0, 20.0, 0.0}));
    EXPECT_EQ(glass.transmission, 0.75);
    EXPECT_EQ(glass.index, 1.33);
    EXPECT_TRUE(glass.is_body);
    EXPECT_EQ(glass.body_colour, (Vec3d{0.9, 0.8, 0.7}));
    EXPECT_EQ(glass.body_depth, 2.5);
    ASSERT_EQ(read.remarks.size(), 4U);
    EXPECT_TRUE(says(read.remarks[0], "KHR_materials_clearcoat is ignored, in 1 of its materials"));
    EXPECT_TRUE(says(read.remarks[1], "alpha is ignored"));
    EXPECT_TRUE(says(read.remarks[2], "normal maps are ignored"));
    EXPECT_TRUE(says(read.remarks[3], "laid out by other uvs"));
    EXPECT_EQ(gltf_references(file, true), std::vector{folder.path() / "plain wood.png"});
    EXPECT_TRUE(gltf_references(file, false).empty());
}

// Two materials of one name, asked for by the meshes in another order than theirs, and a mesh without.
TEST(GltfMaterials, PartsKnowTheirs) {
    const TestFolder folder;
    const fs::path file = folder.path() / "two.gltf";
    write_file(file, squares_gltf(kTwo));
    const MeshFile read = read_mesh(file, {.by_material = true});
    ASSERT_EQ(read.parts.size(), 3U);
    EXPECT_TRUE(read.mesh.triangles.empty());
    for (const MeshPart& part : read.parts) {
        // In the order along x of 1, 0, none.
        const float left = part.material == 1 ? 0.0F : part.material == 0 ? 1000.0F : 2000.0F;
        EXPECT_EQ(part.mesh.positions.at(0).x, left);
        EXPECT_EQ(part.mesh.triangles.size(), 2U);
    }
    EXPECT_EQ(read.parts[2].material, 2U);
    // Without materials it is one mesh, as ever.
    EXPECT_EQ(read_mesh(file).mesh.triangles.size(), 6U);
}

// The point (u, v) of the mesh, v downwards, sees (0.25, 0.5) + R S (u, v), S scaling by (2, 3) and R turning by 0.5
// rad from v to u. (KHR_texture_transform; by hand.)
TEST(GltfMaterials, UvsGoThroughTheTransform) {
    const UvMap map{.set = 0, .offset = {0.25, 0.5}, .scale = {2.0, 3.0}, .turn = 0.5};
    const Vec2<float> at = mapped(map, {0.5F, 0.75F});  // v is 0.25 from the top
    EXPECT_NEAR(at.x, 0.25 + std::cos(0.5) * 1.0 + std::sin(0.5) * 0.75, 1e-6);
    EXPECT_NEAR(1.0 - at.y, 0.5 - std::sin(0.5) * 1.0 + std::cos(0.5) * 0.75, 1e-6);
    const TestFolder folder;
    const fs::path file = folder.path() / "two.gltf";
    write_file(file, squares_gltf(kTwo));
    const MeshFile read = read_mesh(file, {.by_material = true});
    for (const MeshPart& part : read.parts) {
        const Vec2<float> corner = part.mesh.uvs.at(0);  // u 0, v 1 from the top
        const UvMap own = part.material == 0 ? map : UvMap();
        EXPECT_NEAR(corner.x, mapped(own, {0.0F, 0.0F}).x, 1e-6);
        EXPECT_NEAR(corner.y, mapped(own, {0.0F, 0.0F}).y, 1e-6);
    }
}

TEST(GltfMaterials, UnusableOnesAreRefusedByPlace) {
    const TestFolder folder;
    const auto complaint = [&](const std::string& top) {
        const fs::path file = folder.path() / "bad.gltf";
        write_file(file, squares_gltf(top));
        return complaint_about([&] {
            read_gltf_materials(file);
            embedded_picture(file, 0);
            read_mesh(file, {.by_material = true});
        });
    };
    const auto with_texture = [&](const std::string& rest) {
        return complaint(R"("materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}, {}], )" + rest);
    };
    EXPECT_TRUE(says(complaint(R"("materials": [{}, {"pbrMetallicRoughness": {"metallicFactor": 7}}])"),
                     "bad.gltf.materials[1].pbrMetallicRoughness.metallicFactor: is 7, expected a number from 0 to 1"));
    EXPECT_TRUE(says(complaint(R"("materials": [{"emissiveFactor": ["red", 0, 0]}, {}])"),
                     "materials[0].emissiveFactor[0]: is \"red\""));
    EXPECT_TRUE(says(complaint(R"("materials": [3, {}])"), "materials[0]: is no material"));
    EXPECT_TRUE(says(with_texture(R"("textures": [])"), "textures: has 0 entries, of which number 0 is asked for"));
    EXPECT_TRUE(says(with_texture(R"("textures": [{"source": -1}], "images": [{}])"), "source: is -1"));
    EXPECT_TRUE(says(with_texture(R"("textures": [{"source": 0, "sampler": 0}], "images": [{}],
                                     "samplers": [{"wrapS": 5}])"),
                     "samplers[0].wrapS: is 5, expected 10497, 33071 or 33648"));
    const std::string texture = R"("textures": [{"source": 0}], )";
    EXPECT_TRUE(says(with_texture(texture + R"("images": [{"uri": "data:,plain"}])"), "data URI without base64"));
    EXPECT_TRUE(says(with_texture(texture + R"("images": [{"uri": "data:;base64,a!"}])"), "a character of code 33"));
    EXPECT_TRUE(says(with_texture(texture + R"("images": [{"bufferView": 9}])"), "bufferViews"));
    EXPECT_FALSE(with_texture(texture + R"("images": [{}])").empty());
    std::string many = "\"materials\": [{}";
    for (int i = 0; i < 4096; ++i) {
        many += ",{}";
    }
    EXPECT_TRUE(says(complaint(many + "]"), "are 4097, expected at most 4096"));
    const fs::path old = folder.path() / "old.gltf";
    write_file(old, R"({"asset": {"version": "1.0"}, "materials": {"red": {}}})");
    EXPECT_TRUE(says(complaint_about([&] { read_gltf_materials(old); }), "no glTF of version 2"));
}

}  // namespace lensproof::scene::gltf_materials_test
