#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "engine/base/data_root.h"
#include "engine/base/input_error.h"
#include "engine/base/nearest_name.h"
#include "engine/render/scene_setup.h"
#include "engine/scene/scene_shapes.h"

namespace lensproof::scene::scene_file_test {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const std::string kCamera = R"(
[camera]
lens = "tessar"
f_number = 4.0
focus_distance_mm = 2000.0
position_mm = [0.0, 0.0, 0.0]
look_at_mm = [0.0, 0.0, 1000.0]
sensor_mm = [36.0, 24.0]
pixels = [36, 24]
shutter_s = 0.01
iso = 100.0
response = "cie-1931"
)";

const std::string kScene = kCamera + R"(
[[materials]]
name = "white"
kind = "diffuse"
reflectance = 0.8

[[objects]]
name = "ball"
shape = "sphere"
radius_mm = 100.0
material = "white"
translate_mm = [0.0, 0.0, 900.0]

[[lights]]
kind = "point"
position_mm = [0.0, 500.0, 0.0]
intensity_cd = 100.0
)";

render::SceneSetup parse(const std::string& text) {
    return render::parse_scene_setup(text, "scene.toml");
}

std::string refusal(const std::string& text) {
    try {
        parse(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was refused";
}

std::string with(std::string text, const std::string& old, const std::string& put) {
    const auto at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    return text.replace(at, old.size(), put);
}

void expect_refused(const std::string& text, const std::string& said) {
    EXPECT_NE(refusal(text).find(said), std::string::npos) << refusal(text);
    EXPECT_EQ(refusal(text).rfind("scene.toml:", 0), 0U) << refusal(text);
}

TEST(SceneFile, TheExamplesAreRead) {
    const auto read = [](const char* name) {
        return render::read_scene_setup(data_root() / "experiments/scenes" / name);
    };
    const render::SceneSetup box = read("cornell_box.toml");
    EXPECT_EQ(box.scene.objects.size(), 19U);
    EXPECT_EQ(box.camera.model, render::LensModel::pinhole);
    EXPECT_EQ(box.camera.focal_length_mm, 35.0);
    EXPECT_EQ(box.scene.materials.size(), 4U);
    const auto& light = std::get<AreaLightDescription>(box.scene.lights.at(0).kind);
    EXPECT_EQ(box.scene.objects[light.object].name, "lamp");
    ASSERT_TRUE(light.emission.radiance);
    EXPECT_EQ(light.emission.radiance->column, "radiance");
    EXPECT_EQ(read("checker_wall.toml").max_bounces, 5);
    const render::SceneSetup room = read("fisheye_room.toml");
    EXPECT_EQ(std::get<ConductorDescription>(room.scene.materials[3].kind).index.name, "metal:Au");
    EXPECT_EQ(std::get<Sphere>(load_shapes(room.scene).shapes.at(9)).radius_mm, 300.0);
    for (const char* name : {"bokeh_lights.toml", "cornell_box_petzval.toml", "glass_caustic.toml"}) {
        const render::SceneSetup setup = read(name);
        EXPECT_EQ(setup.camera.model, render::LensModel::exact) << name;
        EXPECT_FALSE(setup.scene.objects.empty()) << name;
        EXPECT_FALSE(setup.scene.lights.empty()) << name;
    }
}

// The Cornell box's published dimensions: of its 19 polygons, the areas by the shoelace formula in each one's plane.
TEST(SceneFile, TheCornellBoxIsClosedButForItsFront) {
    const render::SceneSetup box = render::read_scene_setup(data_root() / "experiments/scenes/cornell_box.toml");
    SceneShapes shapes = load_shapes(box.scene);
    const SceneGeometry geometry(std::move(shapes.shapes), std::move(shapes.objects));
    // From the middle of the room, every ray that does not leave by the open front meets a surface, on its inner side
    // or, of the blocks, on its outer one: all face the room.
    const Vec3d from{278.0, 440.0, 280.0};
    int met = 0;
    for (int i = 0; i < 20000; ++i) {
        const double z = 1.0 - (2 * i + 1) / 20000.0;
        const double angle = i * 2.399963229728653;  // the golden angle
        const double across = std::sqrt(1.0 - z * z);
        const Vec3d direction{across * std::cos(angle), across * std::sin(angle), z};
        const auto hit = intersect(geometry, from, direction, 0.0, kInfinity);
        if (hit) {
            EXPECT_LT(dot(hit->geometric_normal, direction), 0.0) << box.scene.objects[hit->object].name;
            ++met;
        } else {
            const Vec3d front = from + (-from.z / direction.z) * direction;
            EXPECT_LT(direction.z, 0.0);
            EXPECT_TRUE(front.x > -1e-6 && front.x < 556.1 && front.y > -1e-6 && front.y < 548.9);
        }
    }
    EXPECT_GT(met, 15000);
}

TEST(SceneFile, DefaultsAreAsDocumented) {
    const render::SceneSetup setup = parse(kScene);
    EXPECT_EQ(setup.camera.model, render::LensModel::exact);
    EXPECT_EQ(setup.samples_per_pixel, 64);
    EXPECT_EQ(setup.max_bounces, 16);
    EXPECT_EQ(setup.spectral.strata(), 64);
    const auto& point = std::get<PointLightDescription>(setup.scene.lights[0].kind);
    EXPECT_EQ(point.illuminant, "D65");
    EXPECT_EQ(setup.scene.objects[0].to_world.translation, (Vec3d{0, 0, 900}));
    EXPECT_EQ(setup.scene.materials[0].where, "scene.toml:14: materials[1]");
}

// A camera that looks along +z with y up has x to the left of the world's right-handed frame.
TEST(SceneFile, TheCameraStandsAsItsKeysSay) {
    const AffineMap ahead = render::camera_to_world({.position_mm = {1, 2, 3}, .look_at_mm = {1, 2, 9}});
    EXPECT_EQ((ahead.linear * Vec3d{1, 0, 0}), (Vec3d{-1, 0, 0}));
    EXPECT_EQ((ahead.linear * Vec3d{0, 1, 0}), (Vec3d{0, -1, 0}));
    EXPECT_EQ((ahead.linear * Vec3d{0, 0, 1}), (Vec3d{0, 0, 1}));
    EXPECT_EQ(ahead.translation, (Vec3d{1, 2, 3}));
    const AffineMap tilted = render::camera_to_world({.look_at_mm = {3, -4, 12}, .up = {0, 0, 1}});
    const Vec3d x = tilted.linear * Vec3d{1, 0, 0};
    const Vec3d y = tilted.linear * Vec3d{0, 1, 0};
    EXPECT_NEAR(length(cross(x, y) - Vec3d{3.0 / 13, -4.0 / 13, 12.0 / 13}), 0.0, 1e-15);
    EXPECT_NEAR(x.z, 0.0, 1e-15);
    EXPECT_LT(y.z, 0.0);
}

TEST(SceneFile, SpectraComeInTheirForms) {
    const auto reflectance = [](const std::string& value) {
        const render::SceneSetup setup = parse(with(kScene, "reflectance = 0.8", "reflectance = " + value));
        return std::get<DiffuseDescription>(setup.scene.materials[0].kind).reflectance;
    };
    EXPECT_EQ(std::get<double>(reflectance("0.25")), 0.25);
    EXPECT_EQ(std::get<RgbColour>(reflectance("[0.1, 0.2, 0.3]")).rgb, (Vec3d{0.1, 0.2, 0.3}));
    EXPECT_EQ(std::get<SpectrumName>(reflectance("\"checker:dark skin\"")).name, "checker:dark skin");
    expect_refused(with(kScene, "reflectance = 0.8", "reflectance = 1.2"), "reflectance: is 1.2");
    expect_refused(with(kScene, "reflectance = 0.8", "reflectance = [0.1, 0.2]"), "expected 3 numbers");
    expect_refused(with(kScene, "reflectance = 0.8", "reflectance = \"paint.csv\""), "paint.csv: no such file");
    expect_refused(with(kScene, "reflectance = 0.8", "reflectance = { image = \"wood.png\" }"),
                   "materials[1].reflectance.image: is \"wood.png\"");
    expect_refused(with(kScene, "reflectance = 0.8", "reflectance = { image = \"\", tint = 3 }"), "image: is \"\"");
    expect_refused(with(kScene, "reflectance = 0.8", "reflectance = \"\""), "is empty");
}

TEST(SceneFile, MaterialsOfEveryKind) {
    const render::SceneSetup setup = parse(kScene + R"(
[[materials]]
name = "silver"
kind = "conductor"
ior = "metal:Ag"
[[materials]]
name = "brass"
kind = "rough-conductor"
n = 0.4
k = [3.6, 2.6, 1.9]
roughness = [0.1, 0.3]
[[materials]]
name = "glass"
kind = "rough-dielectric"
ior = "N-BK7"
roughness = 0.2
absorption_per_mm = 0.001
[[materials]]
name = "cup"
kind = "plastic"
reflectance = [0.2, 0.3, 0.4]
[[materials]]
name = "both"
kind = "mix"
of = ["cup", "silver"]
share = 0.25
)");
    const auto& materials = setup.scene.materials;
    EXPECT_EQ(std::get<ConductorDescription>(materials[1].kind).index.name, "metal:Ag");
    const auto& brass = std::get<ConductorDescription>(materials[2].kind);
    EXPECT_EQ(std::get<double>(brass.index.n), 0.4);
    EXPECT_EQ(brass.roughness.alpha_y, 0.3);
    const auto& glass = std::get<DielectricDescription>(materials[3].kind);
    EXPECT_EQ(std::get<SpectrumName>(glass.index).name, "N-BK7");
    EXPECT_EQ(std::get<double>(glass.absorption_per_mm), 0.001);
    EXPECT_EQ(std::get<double>(std::get<PlasticDescription>(materials[4].kind).index), 1.5);
    const auto& mix = std::get<MixDescription>(materials[5].kind);
    EXPECT_EQ(mix.first, 4U);
    EXPECT_EQ(mix.second, 1U);
    EXPECT_EQ(mix.fraction, 0.25);
}

TEST(SceneFile, MaterialsThatMakeNoSenseAreRefused) {
    const auto refused = [](const std::string& keys, const std::string& said) {
        expect_refused(kScene + "[[materials]]\nname = \"new\"\n" + keys, said);
    };
    refused("kind = \"velvet\"", "kind: is \"velvet\", expected one of: diffuse");
    refused("kind = \"conductor\"\nior = 1.5", "expected a metal's name");
    refused("kind = \"conductor\"\nior = \"metal:Ag\"\nk = 3", "stands beside n or k");
    refused("kind = \"conductor\"", "materials[2].n");
    refused("kind = \"rough-conductor\"\nior = \"metal:Ag\"", "roughness: is missing");
    refused("kind = \"conductor\"\nior = \"metal:Ag\"\nroughness = 0.1", "roughness: is not a key");
    refused("kind = \"dielectric\"\nior = 0.9", "ior: is 0.9");
    refused("kind = \"rough-dielectric\"\nroughness = 1.5", "roughness: is 1.5");
    refused("kind = \"mix\"\nof = [\"white\"]", "names 1 materials, expected two");
    refused("kind = \"mix\"\nof = [\"white\", \"new\"]", "is \"new\", which names no material");
    expect_refused(with(kScene, "name = \"white\"", "name = \"\""), "name: is empty");
    expect_refused(kScene + "[[materials]]\nname = \"white\"\nkind = \"diffuse\"\nreflectance = 0.1",
                   "\"white\" names another material already");
}

TEST(SceneFile, TransformsScaleTurnAndMove) {
    const auto map = [](const std::string& keys) {
        return parse(with(kScene, "translate_mm = [0.0, 0.0, 900.0]", keys)).scene.objects[0].to_world;
    };
    const AffineMap steps =
        map("scale = [2.0, 1.0, 1.0]\nrotate_deg = [0.0, 0.0, 90.0]\ntranslate_mm = [1.0, 2.0, 3.0]");
    EXPECT_NEAR(length(map_point(steps, {1, 0, 0}) - Vec3d{1, 4, 3}), 0.0, 1e-15);
    const AffineMap both = map("rotate_deg = [90.0, 90.0, 0.0]");  // about x first: y to z, then about y: z to x
    EXPECT_NEAR(length(map_point(both, {0, 1, 0}) - Vec3d{1, 0, 0}), 0.0, 1e-15);
    const AffineMap matrix = map("matrix = [[1, 2, 0, 5], [0, 1, 0, 6], [0, 0, 1, 7]]");
    EXPECT_EQ(map_point(matrix, {1, 1, 1}), (Vec3d{8, 7, 8}));
    const auto refused = [](const std::string& keys, const std::string& said) {
        expect_refused(with(kScene, "translate_mm = [0.0, 0.0, 900.0]", keys), said);
    };
    refused("scale = 0.0", "flattens");
    refused("scale = [1, 0, 1]", "flattens");
    refused("matrix = [[1, 2, 0, 5], [0, 1, 0, 6]]", "has 2 rows");
    refused("matrix = [[1, 2, 0], [0, 1, 0, 6], [0, 0, 1, 7]]", "row 1 has 3 numbers");
    refused("matrix = [[1, 2, 0, 5], [1, 2, 0, 6], [0, 0, 1, 7]]", "flattens");
    refused("matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]\nscale = 2.0", "expected it alone");
    refused("translate_mm = [nan, 0, 0]", "translate_mm");
}

TEST(SceneFile, ObjectsThatMakeNoSenseAreRefused) {
    const auto refused = [](const std::string& keys, const std::string& said) {
        expect_refused(kScene + "[[objects]]\n" + keys, said);
    };
    const std::string ball = "shape = \"sphere\"\nradius_mm = 1.0\n";
    refused(ball + "material = \"wite\"", "is \"wite\", which names no material here; did you mean \"white\"?");
    refused(ball, "material: is missing");
    refused(ball + "material = \"white\"\nname = \"ball\"", "\"ball\" names another object already");
    refused(ball + "material = \"white\"\ncolour = 3", "colour: is not a key");
    refused("shape = \"cube\"", "shape: is \"cube\"");
    refused("shape = \"sphere\"\nradius_mm = 0.0\nmaterial = \"white\"", "radius_mm: is 0");
    refused("shape = \"mesh\"\nfile = \"gone.obj\"\nmaterial = \"white\"", "gone.obj: no such file");
    refused("shape = \"polygon\"\nvertices_mm = [[0, 0, 0], [1, 0, 0]]\nmaterial = \"white\"", "has 2 vertices");
    refused("shape = \"polygon\"\nvertices_mm = [[0, 0, 0], [1, 0], [1, 1, 0]]\nmaterial = \"white\"", "vertex 2");
    refused("shape = \"chart\"\nchart = { kind = \"flat-field\" }", "has no size of its own");
    refused("shape = \"chart\"\nchart = { kind = \"checkers\" }", "chart.kind: is \"checkers\"");
    refused("instance_of = \"bell\"", "did you mean \"ball\"?");
    refused("instance_of = \"ball\"\nshape = \"quad\"", "stands beside instance_of");
    refused("instance_of = \"ball\"\nname = \"second\"\n[[objects]]\ninstance_of = \"second\"",
            "is an instance itself");
}

TEST(SceneFile, LightsOfEveryKind) {
    const render::SceneSetup setup = parse(kScene + R"(
[[lights]]
kind = "area"
object = "ball"
luminance_cd_m2 = 50.0
two_sided = true
[[lights]]
kind = "sphere"
position_mm = [1.0, 2.0, 3.0]
radius_mm = 4.0
luminance_cd_m2 = 5.0
illuminant = "A"
[[lights]]
kind = "spot"
position_mm = [0.0, 100.0, 0.0]
look_at_mm = [0.0, 0.0, 0.0]
cone_deg = 30.0
full_deg = 20.0
intensity_cd = 6.0
[[lights]]
kind = "sun"
direction = [0.0, 2.0, 0.0]
illuminance_lx = 100000.0
[[lights]]
kind = "environment"
luminance_cd_m2 = 7.0
)");
    const auto& lights = setup.scene.lights;
    ASSERT_EQ(lights.size(), 6U);
    EXPECT_TRUE(std::get<AreaLightDescription>(lights[1].kind).is_two_sided);
    EXPECT_EQ(std::get<SphereLightDescription>(lights[2].kind).emission.illuminant, "A");
    EXPECT_EQ(std::get<SpotLightDescription>(lights[3].kind).direction, (Vec3d{0, -1, 0}));
    EXPECT_EQ(std::get<SunLightDescription>(lights[4].kind).angular_diameter_deg, 0.53);
    EXPECT_EQ(std::get<SunLightDescription>(lights[4].kind).direction, (Vec3d{0, 1, 0}));
    EXPECT_FALSE(std::get<EnvironmentLightDescription>(lights[5].kind).image);
}

TEST(SceneFile, LightsThatMakeNoSenseAreRefused) {
    const auto refused = [](const std::string& keys, const std::string& said) {
        expect_refused(kScene + "[[lights]]\n" + keys, said);
    };
    refused("kind = \"point\"\nposition_mm = [0, 0, 0]\nintensity_cd = 0.0", "intensity_cd: is 0");
    refused("kind = \"point\"\nposition_mm = [0, 0, 0]", "intensity_cd: is missing");
    refused("kind = \"point\"\nposition_mm = [0, 0, 0]\nintensity_cd = 1\nilluminant = \"D66\"", "'D66' is not known");
    refused("kind = \"area\"\nobject = \"lamp\"\nluminance_cd_m2 = 1", "names no object here");
    refused(
        "kind = \"area\"\nobject = \"ball\"\nluminance_cd_m2 = 1\n[[lights]]\nkind = \"area\"\nobject = \"ball\"\n"
        "luminance_cd_m2 = 2",
        "shines already");
    refused("kind = \"area\"\nobject = \"ball\"\nradiance = 3", "expected a CSV table");
    refused("kind = \"spot\"\nposition_mm = [0, 0, 0]\ndirection = [0, 0, 0]", "has no length");
    refused("kind = \"spot\"\nposition_mm = [0, 0, 0]\ndirection = [0, 0, 1]\ncone_deg = 20\nfull_deg = 21",
            "full_deg");
    refused("kind = \"sun\"\ndirection = [0, 1, 0]\nilluminance_lx = -1", "illuminance_lx: is -1");
    refused("kind = \"environment\"\nimage = \"sky.exr\"\nluminance_cd_m2 = 1", "sky.exr: no such file");
    refused("kind = \"environment\"\nluminance_cd_m2 = 1\n[[lights]]\nkind = \"environment\"\nluminance_cd_m2 = 1",
            "second environment");
    refused("kind = \"laser\"", "kind: is \"laser\"");
    expect_refused(kScene.substr(0, kScene.find("[[lights]]")), "there is no light");
}

TEST(SceneFile, CamerasThatMakeNoSenseAreRefused) {
    expect_refused(with(kScene, "look_at_mm = [0.0, 0.0, 1000.0]", "look_at_mm = [0.0, 0.0, 0.0]"),
                   "where the camera stands");
    expect_refused(with(kScene, "look_at_mm = [0.0, 0.0, 1000.0]", "look_at_mm = [0.0, 9.0, 0.0]"), "looks along up");
    expect_refused(with(kScene, "f_number", "model = \"thick\"\nf_number"), "model: is \"thick\"");
    expect_refused(with(kScene, "f_number", "focal_length_mm = 50.0\nf_number"), "here the lens says it");
    expect_refused(with(kScene, "f_number", "model = \"pinhole\"\nfocal_length_mm = 50.0\nf_number"),
                   "stands beside lens");
    expect_refused(with(kScene, "lens = \"tessar\"\n", ""), "lens: is missing");
    expect_refused(with(kScene, "pixels = [36, 24]", "pixels = [100000, 66666]"), "million pixels at most");
    expect_refused(with(kScene, "f_number", "aperture = 3\nf_number"), "aperture: is not a key");
    expect_refused(kScene + "[render]\nlayers = 3\nstrata_per_layer = 2",
                   "are 6 wavelengths, expected a multiple of 4");
    expect_refused(kScene + "[render]\nsample_per_pixel = 3", "sample_per_pixel: is not a key");
    expect_refused(kScene + "[sun]\nx = 1", "sun: is not a key");
    expect_refused("camera = 3", "camera: is 3, expected a table");
    expect_refused("[camera\n", "not TOML");
}

TEST(SceneFile, InstancesAndFilesShareShapes) {
    const render::SceneSetup setup = parse(kScene + R"(
[[objects]]
instance_of = "ball"
scale = 2.0
[[objects]]
shape = "chart"
chart = { kind = "siemens-star", sectors = 36, radius_mm = 50.0 }
margin_mm = 10.0
)");
    const SceneShapes loaded = load_shapes(setup.scene);
    ASSERT_EQ(loaded.objects.size(), 3U);
    EXPECT_EQ(loaded.shapes.size(), 2U);
    EXPECT_EQ(loaded.objects[1].shape, loaded.objects[0].shape);
    EXPECT_EQ(loaded.objects[1].material, 0U);
    EXPECT_EQ(loaded.objects[2].material, 1U);
    ASSERT_EQ(loaded.own_charts.size(), 1U);
    EXPECT_EQ(loaded.own_charts[0], 2U);
    EXPECT_EQ(std::get<Quad>(loaded.shapes[1]).width_mm, 120.0);
}

TEST(NearestName, TheLeastChangeIsMeant) {
    const std::vector<std::string> known = {"white", "wine", "metal:Ag"};
    EXPECT_EQ(name_hint("whte", known), "; did you mean \"white\"?");
    EXPECT_EQ(name_hint("wines", known), "; did you mean \"wine\"?");
    EXPECT_EQ(name_hint("metal:ag", known), "; did you mean \"metal:Ag\"?");
    EXPECT_EQ(name_hint("plaster", known), "; known are: white, wine, metal:Ag");
    EXPECT_EQ(name_hint("plaster", {}), "");
    EXPECT_EQ(complete_name_hint("wines", known), "; did you mean \"wine\"? Known are: white, wine, metal:Ag");
    EXPECT_EQ(complete_name_hint("plaster", known), "; known are: white, wine, metal:Ag");
}

}  // namespace lensproof::scene::scene_file_test
