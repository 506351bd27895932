// tests/cli/render_passes_test.cpp — `render --passes`: classes of light paths, each a film, and their sum.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::render_passes_test {

using Json = nlohmann::json;

/// A lamp beside the picture and one in it, and a sensor that reflects.
std::string lamps(const std::string& camera = "") {
    return R"([camera]
lens = "triplet-cooke"
f_number = 5.6
focus_distance_mm = 2000.0
position_mm = [0.0, 0.0, 0.0]
look_at_mm = [0.0, 0.0, 1000.0]
sensor_mm = [24.0, 16.0]
pixels = [12, 8]
shutter_s = 0.01
iso = 100.0
response = "cie-1931"
sensor_reflectance = 0.2
)" + camera +
           R"(
[render]
samples_per_pixel = 32
layers = 4
strata_per_layer = 1
[[materials]]
name = "wall"
kind = "diffuse"
reflectance = [0.5, 0.4, 0.3]
[[objects]]
name = "wall"
shape = "quad"
size_mm = [4000.0, 4000.0]
translate_mm = [0.0, 0.0, 2500.0]
material = "wall"
[[lights]]
kind = "sphere"
position_mm = [200.0, 100.0, 2000.0]
radius_mm = 30.0
luminance_cd_m2 = 30000.0
[[lights]]
kind = "point"
position_mm = [300.0, 300.0, 1000.0]
intensity_cd = 1000.0
)";
}

const std::vector<std::string> kRender = {"render", "scene.toml", "--passes", "imaged,direct,ghosts"};

std::vector<std::string> render(std::vector<std::string> more) {
    more.insert(more.begin(), kRender.begin(), kRender.end());
    return more;
}

// The sum is the picture, whichever way the passes came about: side by side, or by two machines.
TEST(RenderPasses, AddUpForShardsToo) {
    const Workplace place;
    place.file("scene.toml", lamps());
    const Json whole = place.json(render({"-o", "whole.exr"}));
    ASSERT_EQ(whole["passes"].size(), 3U);
    for (const Json& pass : whole["passes"]) {
        EXPECT_EQ(pass["samples_per_pixel"], 32.0);
        EXPECT_GT(pass["light"], 0.0) << pass;
    }
    for (const char* part : {"1", "2"}) {
        ASSERT_EQ(place.run(render({"--shard", part + std::string("/2"), "-o", part + std::string(".exr")})).status, 0);
    }
    ASSERT_EQ(place.run({"merge", "2.exr", "1.exr", "-o", "sum.exr"}).status, 0);
    // 1e-6 of values of size 1.
    EXPECT_EQ(place.run({"compare", "sum.exr", "whole.exr", "--rms-limit", "1e-6"}).status, 0);
    ASSERT_EQ(place.run({"render", "scene.toml", "--passes", "ghosts", "-o", "ghosts.exr"}).status, 0);
    EXPECT_EQ(place.run({"compare", "ghosts.exr", "whole.exr", "--rms-limit", "1e-6"}).status, 1);
}

TEST(RenderPasses, AreTheSameForAnyNumberOfThreads) {
    const Workplace place;
    place.file("scene.toml", lamps());
    for (const char* threads : {"1", "2"}) {
        ASSERT_EQ(place.run(render({"--threads", threads, "-o", threads + std::string(".exr")})).status, 0);
    }
    EXPECT_EQ(place.content("1.exr"), place.content("2.exr"));
}

// All light that comes in goes somewhere, whatever is rendered of it.
TEST(RenderPasses, AuditsAllLight) {
    const Workplace place;
    place.file("scene.toml", lamps());
    const Json energy = place.json({"render", "scene.toml", "--spp", "1", "--audit", "-o", "a.exr"})["energy"];
    double sum = 0.0;
    for (const char* fate : {"imaged", "ghosts", "barrel", "beside", "front", "clipped", "absorbed", "lost"}) {
        sum += energy[std::string(fate) + "_percent"].get<double>();
        EXPECT_LT(energy[std::string(fate) + "_standard_error_percent"], 0.5) << fate;
    }
    EXPECT_NEAR(sum, 100.0, 1e-9);
    EXPECT_GT(energy["light_in_w_per_nm"], 0.0);
    EXPECT_GT(energy["ghosts_percent"], 0.0);
}

TEST(RenderPasses, RefuseWhatDoesNotAddUp) {
    const Workplace place;
    place.file("scene.toml", lamps());
    const auto expect_no_render = [&](const std::string& passes, const std::vector<std::string>& words) {
        expect_refused(place, {"render", "scene.toml", "--passes", passes, "-o", "a.exr"}, words);
    };
    expect_no_render("imaged,halo", {"--passes", "halo"});
    expect_no_render("ghosts,ghosts", {"--passes", "ghosts twice"});
    expect_no_render("everything,ghosts", {"--passes", "everything"});
    expect_no_render("straight,direct", {"--passes", "straight", "direct"});
    expect_refused(place, {"render", "scene.toml", "--passes", "ghosts", "--features", "-o", "a.exr"},
                   {"--features", "imaged"});
    place.file("scene.toml",
               with(lamps(), "lens = \"triplet-cooke\"", "model = \"thin-lens\"\nfocal_length_mm = 50.0"));
    expect_no_render("ghosts", {"scene.toml", "camera", "thin-lens", "exact"});
    place.file("scene.toml", with(lamps(), "pixels = [12, 8]", "pixels = [12000, 8000]"));
    expect_no_render("imaged,direct,ghosts", {"3 passes", "GB"});  // each by itself would do
    place.file("scene.toml", lamps("blade_reflectance = 1.5\n"));
    expect_no_render("ghosts", {"scene.toml", "blade_reflectance", "1.5"});
    place.file("scene.toml", small_scene());
    expect_no_render("ghosts", {"--passes", "[chart]"});
    expect_refused(place, {"render", "scene.toml", "--audit", "-o", "a.exr"}, {"--audit", "[chart]"});
    expect_refused(place, {"render", "scene.toml", "--precision", "float", "-o", "a.exr"}, {"--precision", "[chart]"});
}

}  // namespace lensproof::render_passes_test
