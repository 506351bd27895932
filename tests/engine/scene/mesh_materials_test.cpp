#include "engine/scene/mesh_materials.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/file.h"
#include "engine/base/write_file.h"
#include "engine/render/scene_setup.h"
#include "engine/scene/scene_build.h"
#include "engine/spectral/colour_matching.h"
#include "tests/complaint.h"
#include "tests/engine/scene/gltf_cases.h"
#include "tests/test_folder.h"

namespace lensproof::scene::mesh_materials_test {

using test::data_uri;
using test::squares_gltf;

spectral::SpectralGrid grid() {
    return spectral::spectral_grid(400.0, 700.0, 64);
}

/// Two pixels side by side, as a PNG's bytes.
std::string two_pixels(const Vec3d& left, const Vec3d& right) {
    formats::Image image = formats::make_image(2, 1, {"R", "G", "B"});
    for (int x = 0; x < 2; ++x) {
        const Vec3d& rgb = x == 0 ? left : right;
        for (int c = 0; c < 3; ++c) {
            image.at(x, 0, c) = static_cast<float>(c == 0 ? rgb.x : c == 1 ? rgb.y : rgb.z);
        }
    }
    return formats::encode_png(image);
}

constexpr Vec3d kLeft{1.0, 1.0, 1.0};
constexpr Vec3d kRight{0.2, 0.2, 0.2};

/// The first square is glass that shines; the second has a picture, half as bright, which also says that it is rougher
/// and less metal on the right.
std::string squares() {
    return squares_gltf(R"("materials": [
{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "baseColorTexture": {"index": 0},
 "metallicRoughnessTexture": {"index": 0}}},
{"emissiveFactor": [1, 1, 1], "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0},
 "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1},
 "KHR_materials_volume": {"thicknessFactor": 1, "attenuationColor": [0.5, 0.5, 0.5], "attenuationDistance": 2},
 "KHR_materials_emissive_strength": {"emissiveStrength": 30}}}],
"textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071, "wrapT": 33071}],
"images": [{"uri": ")" + data_uri(two_pixels(kLeft, kRight)) +
                        "\"}]");
}

const std::string kScene = R"(
[camera]
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
[[objects]]
name = "squares"
shape = "mesh"
file = "squares.gltf"
)";

/// The table of the uplift is made once.
const Cache& kept() {
    static const TestFolder folder;
    static const Cache cache(folder.path());
    return cache;
}

class MeshMaterialsTest : public testing::Test {
  protected:
    MeshMaterialsTest() { write("squares.gltf", squares()); }

    void write(const std::string& name, const std::string& content) const {
        write_file(folder_.path() / name, content);
    }
    BuiltScene built(const std::string& scene) const {
        write("scene.toml", scene);
        return build_scene(render::read_scene_setup(folder_.path() / "scene.toml").scene, grid(), kept());
    }

  private:
    TestFolder folder_;
};

/// What stands at x, as its material has it there.
MixBsdf at_x(const Scene& scene, double x_mm) {
    const auto hit = intersect(*scene.geometry, {x_mm, 500.0, 10.0}, {0, 0, -1}, 0.0, 1e9);
    return std::get<MixBsdf>(bsdf_at(scene.materials[hit.value().material], hit->uv, grid().path(7)));
}

TEST_F(MeshMaterialsTest, SurfacesAreWhatTheirFileSays) {
    const BuiltScene made = built(kScene);
    EXPECT_EQ(made.scene.geometry->object_count(), 3U);
    const MixBsdf glass = at_x(made.scene, 300.0);
    ASSERT_EQ(glass.count, 1U);
    EXPECT_TRUE(std::holds_alternative<DielectricBsdf>(glass.part[0]));
    // The picture's left pixel: white · 0.5, all metal, as rough as can be; the right 0.2 · 0.5, of metal what sRGB
    // stores for 0.2 (an 8-bit number), 0.4845.
    const MixBsdf left = at_x(made.scene, 1100.0);
    ASSERT_EQ(left.count, 1U);
    EXPECT_NEAR(normal_albedo(left)[0], 0.5, 1e-4);
    EXPECT_EQ(std::get<ConductorBsdf>(left.part[0]).roughness.alpha_x, 1.0);
    const MixBsdf right = at_x(made.scene, 1900.0);
    ASSERT_EQ(right.count, 2U);
    EXPECT_NEAR(right.fraction[0], 0.4845, 0.5 / 255.0);
    const auto& metal = std::get<ConductorBsdf>(right.part[0]);
    EXPECT_NEAR(metal.roughness.alpha_x, 0.4845 * 0.4845, 2.0 * 0.4845 * 0.5 / 255.0);
    EXPECT_NEAR(normal_albedo(metal)[0], 0.1, 9e-4);  // of 8 bits: half a step is 1.7e-3 of light there
    // Without a material: white metal, as rough as can be.
    EXPECT_NEAR(normal_albedo(at_x(made.scene, 2500.0))[0], 1.0, 2e-4);
}

// Of the scene file's own materials those with a picture need to know where on a sphere they are.
TEST_F(MeshMaterialsTest, SpheresFindTheirUvForPicturesAlone) {
    write("picture.png", two_pixels(kLeft, kRight));
    const BuiltScene made = built(kScene + R"(
[[objects]]
name = "even"
shape = "sphere"
radius_mm = 10.0
material = "even"
[[objects]]
name = "painted"
shape = "sphere"
radius_mm = 10.0
material = "painted"
[[materials]]
name = "even"
kind = "diffuse"
reflectance = 0.5
[[materials]]
name = "painted"
kind = "plastic"
reflectance = { image = "picture.png" }
)");
    const SceneGeometry& geometry = *made.scene.geometry;
    const auto objects = static_cast<std::uint32_t>(geometry.object_count());
    EXPECT_FALSE(geometry.object(objects - 2).reads_uv);
    EXPECT_TRUE(geometry.object(objects - 1).reads_uv);
}

// Inside the glass half of the light is left after 2 m; and it shines with 30 times (1, 1, 1) in cd/m², or as many
// times that as the scene says.
TEST_F(MeshMaterialsTest, LightIsWhatTheFileSays) {
    for (const double unit : {1.0, 200.0}) {
        const BuiltScene made = built(kScene + "cd_m2_per_unit = " + std::to_string(unit) + "\n");
        const auto hit = intersect(*made.scene.geometry, {300.0, 500.0, 10.0}, {0, 0, -1}, 0.0, 1e9);
        ASSERT_TRUE(hit);
        EXPECT_NEAR((*made.scene.absorption[hit->material])(grid().path(0))[0], std::log(2.0) / 2000.0, 1e-7);
        ASSERT_EQ(made.scene.lights.size(), 1U);
        double luminance = 0.0;
        const spectral::ColourMatching observer = spectral::cie_1931();
        for (int i = 0; i < grid().size(); ++i) {
            const auto light = made.scene.lights.emitted(*hit, {300.0, 500.0, 10.0}, {0, 0, -1}, grid().path(i));
            const double nm = grid().strata.midpoint(i);
            luminance += 683.0 * light.radiance[0] * observer.y_bar(nm) * 300.0 / grid().size();
        }
        EXPECT_NEAR(luminance, 30.0 * unit, 0.005 * 30.0 * unit);  // beyond 400 to 700 nm lies 0.2 % of ȳ D65
    }
}

/// A picture shines where it is bright: radiance there by its colour, and light paths begin there.
TEST_F(MeshMaterialsTest, PicturesShine) {
    write("squares.gltf",
          squares_gltf(R"("materials": [{}, {"emissiveFactor": [100, 100, 100], "emissiveTexture": {"index": 0}}],
"textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071, "wrapT": 33071}],
"images": [{"uri": "lamp.png"}])"));
    EXPECT_TRUE(
        says(complaint_about([&] { built(kScene); }), "emissiveFactor[0]: is 100, expected a number from 0 to 1"));
    write("squares.gltf",
          squares_gltf(R"("materials": [{}, {"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0}}],
"textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071, "wrapT": 33071}],
"images": [{"uri": "lamp.png"}])"));
    EXPECT_TRUE(says(complaint_about([&] { built(kScene); }), "lamp.png"));
    write("lamp.png", two_pixels({1.0, 1.0, 1.0}, {0.0, 0.0, 0.0}));
    const BuiltScene made = built(kScene);
    ASSERT_EQ(made.scene.lights.size(), 1U);
    const auto at = [&](double x) {
        const Vec3d from{x, 500.0, 10.0};
        const auto hit = intersect(*made.scene.geometry, from, {0, 0, -1}, 0.0, 1e9);
        return made.scene.lights.emitted(*hit, from, {0, 0, -1}, grid().path(8)).radiance[0];
    };
    EXPECT_GT(at(100.0), 0.0F);
    EXPECT_NEAR(at(500.0), 0.5F * at(100.0), 1e-3F * at(100.0));
    EXPECT_EQ(at(900.0), 0.0F);
    // Sampled from a point in front it is the irradiance of the bright half and the ramp between the pixels' centres:
    // the quadrature of L cos² dA / d², L as above.
    const Vec3d point{500.0, 500.0, 800.0};
    double sampled = 0.0;
    double expected = 0.0;
    constexpr int kSide = 64;
    for (int i = 0; i < kSide; ++i) {
        for (int j = 0; j < kSide; ++j) {
            const double u = (i + 0.5) / kSide;
            const double v = (j + 0.5) / kSide;
            if (const auto light = made.scene.lights.sample(point, grid().path(8), {0.5, {u, v}})) {
                sampled += light->value[0] * -light->direction.z / (kSide * kSide);
            }
            const Vec3d along = Vec3d{1000.0 * u, 1000.0 * v, 0.0} - point;
            const double squared = dot(along, along);
            const double radiance = at(100.0) * std::clamp(1.5 - 2.0 * u, 0.0, 1.0);
            expected += radiance * along.z * along.z / (squared * squared) * 1e6 / (kSide * kSide);
        }
    }
    EXPECT_NEAR(sampled, expected, 0.01 * expected);  // of 4096 even points on two triangles
}

TEST_F(MeshMaterialsTest, ASceneMayOverrule) {
    const std::string red = "[[materials]]\nname = \"red\"\nkind = \"diffuse\"\nreflectance = 0.3\n";
    const std::string lamp = "[[lights]]\nkind = \"area\"\nobject = \"squares\"\nluminance_cd_m2 = 100.0\n";
    const BuiltScene lit = built(kScene + lamp);
    EXPECT_EQ(lit.scene.lights.size(), 3U) << "each part, in place of the file's";
    const BuiltScene painted = built(kScene + "material = \"red\"\n" + red + lamp);
    EXPECT_EQ(painted.scene.geometry->object_count(), 1U);
    EXPECT_EQ(painted.scene.lights.size(), 1U);
    const BuiltScene twice = built(kScene + "[[objects]]\ninstance_of = \"squares\"\ntranslate_mm = [0, 0, -500]\n");
    EXPECT_EQ(twice.scene.geometry->object_count(), 6U);
    EXPECT_EQ(twice.scene.lights.size(), 2U);
    EXPECT_EQ(twice.scene.materials.size(), 3U);
    write("squares.gltf", squares_gltf(R"("materials": [{}, {}])"));
    EXPECT_TRUE(says(complaint_about([&] { built(kScene); }), "there is no light"));
    EXPECT_TRUE(
        says(complaint_about([&] { built(kScene + "material = \"red\"\ncd_m2_per_unit = 2.0\n" + red + lamp); }),
             "cd_m2_per_unit"));
}

// A picture is judged as any other, by its place in the file.
TEST_F(MeshMaterialsTest, UnusablePicturesAreNamed) {
    const auto complaint = [&](const std::string& image) {
        write(
            "squares.gltf",
            squares_gltf(
                R"("materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}, {"emissiveFactor": [1, 1, 1]}],
"textures": [{"source": 0}], "images": [)" +
                image + "]"));
        return complaint_about([&] { built(kScene); });
    };
    EXPECT_TRUE(says(complaint(R"({"uri": ")" + data_uri("no picture at all") + "\"}"),
                     "squares.gltf: images[0]: not a picture that can be read"));
    EXPECT_TRUE(says(complaint(R"({"uri": "nowhere.png"})"), "nowhere.png"));
    EXPECT_TRUE(
        says(complaint(R"({"bufferView": 0, "mimeType": "image/png"})"), "squares.gltf: images[0]: not a picture"));
}

}  // namespace lensproof::scene::mesh_materials_test
