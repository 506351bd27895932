// tests/cli/untrusted_test.cpp — `--untrusted`: the same results, and no reference that leads out of a file's folder.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/formats/image/image.h"
#include "tests/cli/program.h"
#include "tests/engine/scene/gltf_cases.h"

namespace lensproof::untrusted_test {

const std::string kScene = R"([camera]
model = "pinhole"
focal_length_mm = 50.0
f_number = 4.0
focus_distance_mm = 2000.0
position_mm = [0.0, 0.0, 0.0]
look_at_mm = [0.0, 0.0, 2000.0]
sensor_mm = [36.0, 24.0]
pixels = [24, 16]
shutter_s = 0.01
iso = 100.0
response = "cie-1931"
[render]
samples_per_pixel = 16
layers = 4
[[materials]]
name = "wall"
kind = "diffuse"
reflectance = 0.5
[[objects]]
shape = "mesh"
file = "m.obj"
material = "wall"
[[lights]]
kind = "environment"
luminance_cd_m2 = 1000.0
)";

void put_scene(const Workplace& place) {
    place.file("in/m.obj",
               "mtllib ../else.mtl\nv 0 0 1500\nv 0 900 1500\nv 900 0 1500\nvt 0 0\nvt 0 1\nvt 1 0\n"
               "f 1/1 2/2 3/3\n");
    formats::Image picture = formats::make_image(4, 4, {"R", "G", "B"});
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        picture.pixels[i] = 0.02F * static_cast<float>(i);
    }
    formats::write_png(picture, place.path() / "in/picture.png");
}

TEST(Untrusted, GivesTheSameResults) {
    const Workplace place;
    put_scene(place);
    place.file("in/scene.toml", with(kScene, "0.5", "{ image = \"picture.png\" }"));
    const Outcome trusted = place.run({"render", "in/scene.toml", "-o", "a.exr"});
    ASSERT_EQ(trusted.status, 0) << trusted.err;
    const Outcome untrusted = place.run({"render", "in/scene.toml", "--untrusted", "-o", "b.exr"});
    ASSERT_EQ(untrusted.status, 0) << untrusted.err;
    EXPECT_EQ(untrusted.err, trusted.err);
    EXPECT_EQ(place.content("b.exr"), place.content("a.exr"));
    const Outcome compared = place.run({"compare", "a.exr", "b.exr", "--untrusted"});
    EXPECT_EQ(compared.status, 0) << compared.err;
    EXPECT_EQ(place.run({"merge", "a.exr", "-o", "c.exr", "--untrusted"}).err,
              place.run({"merge", "a.exr", "-o", "c.exr"}).err);
}

TEST(Untrusted, RefusesReferencesThatLeaveTheFolder) {
    const Workplace place;
    put_scene(place);
    place.file("else.csv", "wavelength_nm,reflectance\n400,0.5\n700,0.5\n");
    std::filesystem::create_symlink("../else.csv", place.path() / "in/link.csv");
    const std::string lens =
        "name = \"l\"\nsource = \"s\"\n[[surfaces]]\nradius_mm = 50.0\nthickness_mm = 5.0\n"
        "semi_diameter_mm = 10.0\nglass = \"N-BK7\"\n[[surfaces]]\nradius_mm = -50.0\n"
        "thickness_mm = 1.0\nsemi_diameter_mm = 10.0\n[[surfaces]]\nstop = true\n"
        "thickness_mm = 45.0\nsemi_diameter_mm = 5.0\n";
    place.file("in/l.toml", "catalogues = [\"../else.csv\"]\n" + lens);
    place.file("else.toml", lens);
    const auto refused = [&](const std::string& scene, const std::string& name) {
        place.file("in/scene.toml", scene);
        expect_refused(place, {"render", "in/scene.toml", "-o", "a.exr", "--untrusted"},
                       {"scene.toml", name, "--untrusted"});
    };
    refused(with(kScene, "0.5", "{ image = \"../in2/picture.png\" }"), "../in2/picture.png");
    refused(with(kScene, "0.5", "\"../else.csv\""), "else.csv");
    refused(with(kScene, "0.5", "\"link.csv\""), "link.csv");
    refused(with(kScene, "m.obj", "/etc/passwd"), "/etc/passwd");
    refused(with(kScene, "model = \"pinhole\"\nfocal_length_mm = 50.0", "lens = \"else.toml\""), "else.toml");
    expect_refused(place, {"analyze", "in/l.toml", "--untrusted"}, {"l.toml", "else.csv", "--untrusted"});
}

// A buffer that lies elsewhere is refused, and not to be had by the process that reads the mesh.
TEST(Untrusted, MeshesReadNothingElse) {
    const Workplace place;
    put_scene(place);
    place.file("else.bin", std::string(1000, '\0'));
    place.file("in/m.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
  "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0,0,0], "max": [0,0,0]}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri": "../else.bin"}]})");
    place.file("in/scene.toml", with(kScene, "m.obj", "m.gltf"));
    expect_refused(place, {"render", "in/scene.toml", "-o", "a.exr", "--untrusted"},
                   {"m.gltf", "else.bin", "--untrusted"});
}

// A picture that a mesh's material names is another file that is referred to.
TEST(Untrusted, MaterialsOfMeshesLeadNowhereElse) {
    const Workplace place;
    put_scene(place);
    std::filesystem::copy_file(place.path() / "in/picture.png", place.path() / "else.png");
    std::filesystem::create_symlink("../else.png", place.path() / "in/link.png");
    place.file("in/scene.toml", with(with(kScene, "m.obj", "m.gltf"), "material = \"wall\"\n", ""));
    const auto mesh_with = [&](const std::string& picture) {
        place.file("in/m.gltf",
                   scene::test::squares_gltf(R"("textures": [{"source": 0}], "images": [{"uri": ")" + picture +
                                             R"("}], "materials": [{}, {"pbrMetallicRoughness": {"baseColorTexture":
                                             {"index": 0}}}])"));
    };
    for (const std::string picture : {"../else.png", "link.png"}) {
        mesh_with(picture);
        expect_refused(place, {"render", "in/scene.toml", "-o", "a.exr", "--untrusted"},
                       {"m.gltf", picture, "--untrusted"});
    }
    mesh_with("picture.png");
    const Outcome trusted = place.run({"render", "in/scene.toml", "-o", "a.exr"});
    ASSERT_EQ(trusted.status, 0) << trusted.err;
    ASSERT_EQ(place.run({"render", "in/scene.toml", "-o", "b.exr", "--untrusted"}).status, 0);
    EXPECT_EQ(place.content("b.exr"), place.content("a.exr"));
}

}  // namespace lensproof::untrusted_test
