// tests/cli/render_scene_test.cpp — `render` of scenes: from either end, and what a scene may not be.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::render_scene_test {

/// A lamp over a floor, seen by `camera` lines; `more` is added.
std::string lamp_over_floor(const std::string& camera, const std::string& more = "") {
    return fmt::format(R"([camera]
{}
f_number = 4.0
focus_distance_mm = 2000.0
position_mm = [0.0, 300.0, 0.0]
look_at_mm = [0.0, 0.0, 2000.0]
sensor_mm = [36.0, 24.0]
pixels = [24, 16]
shutter_s = 0.01
iso = 100.0
response = "cie-1931"
[render]
samples_per_pixel = 32
layers = 8
[[materials]]
name = "floor"
kind = "diffuse"
reflectance = [0.5, 0.4, 0.3]
[[objects]]
name = "floor"
shape = "quad"
size_mm = [4000.0, 4000.0]
rotate_deg = [-90.0, 0.0, 0.0]
translate_mm = [0.0, -200.0, 2000.0]
material = "floor"
[[lights]]
kind = "sphere"
position_mm = [200.0, 300.0, 1800.0]
radius_mm = 80.0
luminance_cd_m2 = 30000.0
{})",
                       camera, more);
}

const std::string kLens = "lens = \"double-gauss-tronnier\"";

// Camera paths and light paths are estimates of one image, here with a noise of 0.02; upside down or mirrored it would
// differ by a tenth at least.
TEST(RenderScene, IsOneImageFromEitherEnd) {
    const Workplace place;
    place.file("scene.toml", lamp_over_floor(kLens));
    ASSERT_EQ(place.run({"render", "scene.toml", "--spp", "256", "-o", "camera.exr"}).status, 0);
    ASSERT_EQ(place.run({"render", "scene.toml", "--spp", "1024", "--paths", "light", "-o", "light.exr"}).status, 0);
    const Outcome same = place.run({"compare", "camera.exr", "light.exr", "--rms-limit", "0.05"});
    EXPECT_EQ(same.status, 0) << same.out;
    ASSERT_EQ(place.run({"render", "scene.toml", "--spp", "256", "--paths", "both", "-o", "both.exr"}).status, 0);
    const Outcome together = place.run({"compare", "camera.exr", "both.exr", "--rms-limit", "0.05"});
    EXPECT_EQ(together.status, 0) << together.out;
    const Outcome alike = place.run({"compare", "camera.exr", "light.exr", "--rms-limit", "1e-5"});
    EXPECT_EQ(alike.status, 1) << alike.out;
}

// --model stands in the place of the scene's; files say which it was. 0.02 is the noise of both; a pinhole's picture of
// this scene is a sharper one.
TEST(RenderScene, TakesAnotherModelThanTheScenes) {
    const Workplace place;
    place.file("scene.toml", lamp_over_floor(kLens));
    place.file("pinhole.toml", lamp_over_floor(kLens + "\nmodel = \"pinhole-profile\""));
    place.file("blades.toml", lamp_over_floor(kLens + "\nblades = 6"));
    const auto render = [&](const char* scene, const char* model, const char* picture) {
        return place.run({"render", scene, "--model", model, "--spp", "16", "--json", "-", "-o", picture});
    };
    const Outcome pinhole = render("scene.toml", "pinhole-profile", "a.exr");
    ASSERT_EQ(pinhole.status, 0) << pinhole.err;
    EXPECT_EQ(nlohmann::json::parse(pinhole.out).at("model"), "pinhole-profile");
    ASSERT_EQ(place.run({"render", "pinhole.toml", "--spp", "16", "-o", "b.exr"}).status, 0);
    EXPECT_EQ(place.run({"compare", "a.exr", "b.exr", "--rms-limit", "1e-9"}).status, 0);
    const Outcome exact = render("pinhole.toml", "exact-double", "c.exr");
    EXPECT_EQ(nlohmann::json::parse(exact.out).at("model"), "exact-double");
    const Outcome blades = render("blades.toml", "thin-lens-profile", "d.exr");
    EXPECT_EQ(blades.status, 2);
    EXPECT_TRUE(says(blades.err, "--model is \"thin-lens-profile\", but in blades.toml the camera's blades"));
    EXPECT_EQ(render("blades.toml", "exact-float", "e.exr").status, 0);
    EXPECT_EQ(render("scene.toml", "fish", "f.exr").status, 2);
}

/// An OBJ file of a wavy sheet, 1 × 1 about the origin: 288 triangles, more than are met one by one.
std::string wavy_sheet() {
    constexpr int kCells = 12;
    constexpr double kSize = kCells;
    std::string text;
    for (int y = 0; y <= kCells; ++y) {
        for (int x = 0; x <= kCells; ++x) {
            text += fmt::format("v {} {} {}\n", x / kSize - 0.5, y / kSize - 0.5, 0.02 * ((x + y) % 3));
        }
    }
    for (int y = 0; y < kCells; ++y) {
        for (int x = 0; x < kCells; ++x) {
            const int at = y * (kCells + 1) + x + 1;
            text += fmt::format("f {0} {1} {2}\nf {0} {2} {3}\n", at, at + 1, at + kCells + 2, at + kCells + 1);
        }
    }
    return text;
}

// --precision stands in the place of the scene's. Paths have the same numbers in float and leave the sheet by a
// hundredth of a mm more: pictures are the same far within the noise of 0.1.
TEST(RenderScene, TakesAnotherPrecisionThanTheScenes) {
    const Workplace place;
    place.file("sheet.obj", wavy_sheet());
    const std::string sheet =
        "[[objects]]\nshape = \"mesh\"\nfile = \"sheet.obj\"\nscale = 1000.0\nmaterial = \"floor\"\n"
        "rotate_deg = [-60.0, 0.0, 0.0]\ntranslate_mm = [0.0, 0.0, 2000.0]\n";
    const std::string in_double = lamp_over_floor("model = \"pinhole\"\nfocal_length_mm = 50.0", sheet);
    place.file("scene.toml", in_double);
    std::string in_float = in_double;
    in_float.insert(in_float.find("[render]") + 9, "precision = \"float\"\n");
    place.file("float.toml", in_float);
    const auto render = [&](const char* scene, const std::vector<std::string>& more, const char* picture) {
        std::vector<std::string> arguments = {"render", scene, "-o", picture};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return place.json(arguments)["precision"];
    };
    EXPECT_EQ(render("scene.toml", {}, "double.exr"), "double");
    EXPECT_EQ(render("scene.toml", {"--precision", "float"}, "float.exr"), "float");
    EXPECT_EQ(render("float.toml", {}, "own.exr"), "float");
    EXPECT_EQ(render("float.toml", {"--precision", "double"}, "again.exr"), "double");
    const auto differ = [&](const char* a, const char* b, const char* limit) {
        return place.run({"compare", a, b, "--rms-limit", limit}).status;
    };
    const auto render_shard = [&](const char* shard, const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"render", "scene.toml", "--shard",
                                              shard,    "-o",         std::string(1, shard[0]) + ".exr"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return place.run(arguments).status;
    };
    ASSERT_EQ(render_shard("1/2", {}) + render_shard("2/2", {"--precision", "double"}), 0);
    EXPECT_EQ(place.run({"merge", "1.exr", "2.exr", "-o", "merged.exr"}).status, 0);
    ASSERT_EQ(render_shard("2/2", {"--precision", "float"}), 0);
    EXPECT_EQ(place.run({"merge", "1.exr", "2.exr", "-o", "mixed.exr"}).status, 2);
    EXPECT_EQ(differ("float.exr", "own.exr", "1e-9"), 0);
    EXPECT_EQ(differ("double.exr", "again.exr", "1e-9"), 0);
    EXPECT_EQ(differ("double.exr", "float.exr", "1e-9"), 1);
    EXPECT_EQ(differ("double.exr", "float.exr", "0.01"), 0);
    place.file("half.toml", std::string(in_float).replace(in_float.find("\"float\""), 7, "\"half\""));
    const Outcome half = place.run({"render", "half.toml", "-o", "h.exr"});
    EXPECT_EQ(half.status, 2);
    EXPECT_TRUE(says(half.err, "precision") && says(half.err, "half")) << half.err;
}

TEST(RenderScene, IsTheSameForAnyNumberOfThreads) {
    const Workplace place;
    place.file("scene.toml", lamp_over_floor(kLens));
    for (const char* paths : {"camera", "both"}) {
        ASSERT_EQ(place.run({"render", "scene.toml", "--paths", paths, "--threads", "1", "-o", "one.exr"}).status, 0);
        ASSERT_EQ(place.run({"render", "scene.toml", "--paths", paths, "--threads", "3", "-o", "three.exr"}).status, 0);
        EXPECT_EQ(place.content("one.exr"), place.content("three.exr")) << paths;
    }
}

TEST(RenderScene, TakesEveryModelOfTheLens) {
    const Workplace place;
    for (const std::string& camera :
         {kLens + "\nmodel = \"paraxial\"", kLens + "\nmodel = \"thin-lens\"", kLens + "\nmodel = \"pinhole\"",
          std::string("focal_length_mm = 50.0\nmodel = \"thin-lens\"")}) {
        place.file("scene.toml", lamp_over_floor(camera));
        const Outcome outcome = place.run({"render", "scene.toml", "--features", "--paths", "both", "-o", "a.exr"});
        EXPECT_EQ(outcome.status, 0) << camera << outcome.err;
    }
}

// Camera and light paths together go on from a checkpoint with every byte, add up from shards to 1e-6 of values of size
// 1, and end where the noise is low.
TEST(RenderScene, GrowsByBothPaths) {
    const Workplace place;
    place.file("scene.toml", lamp_over_floor(kLens));
    const auto render = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"render", "scene.toml", "--paths", "both"});
        return place.json(more);
    };
    render({"--spp", "64", "-o", "whole.exr"});
    render({"--spp", "16", "--checkpoint", "state", "-o", "grown.exr"});
    render({"--spp", "64", "--checkpoint", "state", "-o", "grown.exr"});
    EXPECT_EQ(place.content("grown.exr"), place.content("whole.exr"));
    const Outcome other = place.run({"render", "scene.toml", "--spp", "64", "--checkpoint", "state", "-o", "o.exr"});
    EXPECT_EQ(other.status, 2) << "a checkpoint of both is none of camera paths";

    render({"--spp", "64", "--shard", "1/2", "-o", "part1.exr"});
    render({"--spp", "64", "--shard", "2/2", "-o", "part2.exr"});
    ASSERT_EQ(place.run({"merge", "part2.exr", "part1.exr", "-o", "sum.exr"}).status, 0);
    const Outcome sum = place.run({"compare", "sum.exr", "whole.exr", "--rms-limit", "1e-6"});
    EXPECT_EQ(sum.status, 0) << sum.out;

    const nlohmann::json quiet = render({"--noise", "0.03", "-o", "quiet.exr"});
    EXPECT_LE(quiet["relative_error"], 0.03);
    EXPECT_GT(quiet["samples_per_pixel"], 64.0);
}

// A sky so bright that what is sampled of it is no finite number of float: it is left out, and that is said.
TEST(RenderScene, SaysWhatItLeftOut) {
    const Workplace place;
    place.file("bright.csv", "wavelength_nm,radiance\n300,1e38\n900,1e38\n");
    place.file("scene.toml", lamp_over_floor("model = \"pinhole\"\nfocal_length_mm = 50.0",
                                             "[[lights]]\nkind = \"environment\"\nradiance = \"bright.csv\"\n"));
    const Outcome outcome = place.run({"render", "scene.toml", "--paths", "both", "-o", "a.exr", "--json", "-"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(says(outcome.err, "left out"));
    EXPECT_GT(nlohmann::json::parse(outcome.out)["samples_left_out"], 0);
    EXPECT_TRUE(says(place.content("a.exr"), "lensproof:leftOut"));
}

TEST(RenderScene, RefusesWhatItCannotRender) {
    const Workplace place;
    const auto refuses = [&](const std::string& scene, const std::vector<std::string>& more,
                             const std::vector<std::string>& words) {
        place.file("scene.toml", scene);
        std::vector<std::string> arguments{"render", "scene.toml", "-o", "a.exr"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        expect_refused(place, arguments, words);
    };
    refuses(lamp_over_floor(kLens), {"--paths", "light", "--noise", "0.1"}, {"--noise", "--paths both"});
    refuses(lamp_over_floor(kLens), {"--paths", "lamp"}, {"--paths", "lamp"});
    refuses(small_scene(), {"--paths", "both"}, {"--paths", "[chart]"});
    refuses(lamp_over_floor("lens = \"nothing\""), {}, {"scene.toml", "nothing"});
    refuses(lamp_over_floor(kLens, "[[materials]]\nname = \"m\"\nkind = \"conductor\"\nior = \"metal:Xx\"\n"), {},
            {"scene.toml", "materials", "Xx", "gold"});
    refuses(lamp_over_floor(kLens, "[[materials]]\nname = \"m\"\nkind = \"dielectric\"\nior = \"N-BK77\"\n"), {},
            {"scene.toml", "materials", "N-BK77", "N-BK7"});
    refuses(lamp_over_floor(kLens,
                            "[[lights]]\nkind = \"area\"\nobject = \"floor\"\nluminance_cd_m2 = 1.0\n"
                            "[[lights]]\nkind = \"area\"\nobject = \"floor\"\nluminance_cd_m2 = 2.0\n"),
            {}, {"scene.toml", "lights", "shines already"});
    place.file("dark.csv", "wavelength_nm,radiance\n800,1\n900,1\n");
    refuses(lamp_over_floor(kLens, "[[lights]]\nkind = \"environment\"\nradiance = \"dark.csv\"\n"), {},
            {"scene.toml", "lights", "no power"});
    place.file("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    refuses(lamp_over_floor(kLens, "[[objects]]\nshape = \"mesh\"\nfile = \"flat.obj\"\nmaterial = \"floor\"\n"), {},
            {"scene.toml", "flat.obj"});
}

// A render goes on only from what it began with, the files that the scene names included.
TEST(RenderScene, KnowsTheFilesThatASceneNames) {
    const Workplace place;
    const std::string mesh = "[[objects]]\nshape = \"mesh\"\nfile = \"m.obj\"\nmaterial = \"floor\"\n";
    place.file("scene.toml", lamp_over_floor(kLens, mesh));
    place.file("m.obj", "v 0 0 1500\nv 90 0 1500\nv 0 90 1500\nf 1 2 3\n");
    ASSERT_EQ(place.run({"render", "scene.toml", "--checkpoint", "c", "-o", "a.exr"}).status, 0);
    ASSERT_EQ(place.run({"render", "scene.toml", "--checkpoint", "c", "--spp", "64", "-o", "a.exr"}).status, 0);
    place.file("m.obj", "v 0 0 1500\nv 91 0 1500\nv 0 90 1500\nf 1 2 3\n");
    const Outcome other = place.run({"render", "scene.toml", "--checkpoint", "c", "--spp", "64", "-o", "a.exr"});
    EXPECT_EQ(other.status, 2) << other.err;
    place.file("m.obj", "f 1 2 3\n");
    const Outcome damaged = place.run({"render", "scene.toml", "-o", "b.exr"});
    EXPECT_TRUE(damaged.err.starts_with("lensproof: scene.toml: m.obj")) << damaged.err;
}

}  // namespace lensproof::render_scene_test
