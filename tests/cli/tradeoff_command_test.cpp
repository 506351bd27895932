// tests/cli/tradeoff_command_test.cpp — `lensproof tradeoff` as a user meets it: its JSON, its drawings, what it
// refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::tradeoff_command_test {

using Json = nlohmann::json;

constexpr const char* kScene = R"([camera]
lens = "tessar"
f_number = 4.5
focus_distance_mm = 3000.0
position_mm = [0.0, 0.0, 0.0]
look_at_mm = [0.0, 0.0, 3000.0]
sensor_mm = [60.0, 40.0]
pixels = [600, 400]
shutter_s = 0.01
iso = 100.0
response = "cie-1931"
[render]
layers = 8
strata_per_layer = 1
max_bounces = 1
[[materials]]
name = "grey"
kind = "diffuse"
reflectance = 0.5
[[objects]]
name = "wall"
shape = "chart"
chart = { kind = "checkerboard", squares = [24, 16], square_mm = 100.0 }
rotate_deg = [0.0, 180.0, 0.0]
translate_mm = [0.0, 0.0, 3000.0]
[[lights]]
kind = "sphere"
position_mm = [0.0, 1500.0, 1000.0]
radius_mm = 200.0
luminance_cd_m2 = 100000.0
)";

const std::vector<std::string> kQuick = {"tradeoff", "scene.toml", "--pixels", "600", "--spp", "16", "--seeds", "2"};

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

TEST(TradeoffCommand, ReportsWhatTheContractSays) {
    const Workplace place;
    place.file("scene.toml", kScene);
    const Json result =
        place.json(with(kQuick, {"--rungs", "thin-lens,pinhole", "--plot", "front.svg", "--report", "page.html"}));
    EXPECT_EQ(result["reference"], "exact-double");
    ASSERT_EQ(result["rungs"].size(), 3U);
    for (const Json& rung : result["rungs"]) {
        for (const char* key :
             {"position_rms_um", "image_rms_px", "mtf_difference_rms", "exposure_ev", "ciede2000_mean", "flip"}) {
            EXPECT_GE(rung["error"][key].get<double>(), 0.0);
            EXPECT_GE(rung["error"][std::string(key) + "_standard_error"].get<double>(), 0.0);
        }
        EXPECT_GT(rung["cost"]["ns_per_path"].get<double>(), 0.0);
        EXPECT_GT(rung["cost"]["seconds"].get<double>(), 0.0);
        EXPECT_TRUE(rung["cost"]["memory_mib"].is_number());
        EXPECT_TRUE(rung["pareto"].is_boolean());
    }
    const Json& exact = result["rungs"][2];
    EXPECT_EQ(exact["model"], "exact-double");
    EXPECT_EQ(exact["error"]["position_rms_um"], 0.0);
    EXPECT_TRUE(exact["pareto"]);
    // A thin lens has none of the Tessar's aberrations, nor its rims.
    EXPECT_GT(result["rungs"][1]["error"]["exposure_ev"].get<double>(), 0.01);
    EXPECT_GT(result["rungs"][1]["error"]["position_rms_um"].get<double>(), 5.0);
    EXPECT_NE(place.content("front.svg").find("</svg>"), std::string::npos);
    EXPECT_NE(place.content("page.html").find("thin-lens"), std::string::npos);
}

// With hits in float rays come out of the lens as they do, and the picture is the same but for noise; where the scene
// has no triangles there is no such rung.
TEST(TradeoffCommand, HitsInFloatAreARungOfScenesWithTriangles) {
    const Workplace place;
    const auto rung = [&](const std::string& more) {
        place.file("scene.toml", kScene + more);
        return place.json(with(kQuick, {"--rungs", "exact-double-float-hits"}))["rungs"][1];
    };
    EXPECT_TRUE(says(rung("")["not_applicable"], "no triangles"));
    const Json with_triangles = rung(
        "[[objects]]\nshape = \"polygon\"\nvertices_mm = [[0, 0, 2500], [0, 300, 2500], [300, 300, 2500]]\nmaterial = "
        "\"grey\"\n");
    EXPECT_EQ(with_triangles["error"]["position_rms_um"], 0.0);
    EXPECT_LT(with_triangles["error"]["ciede2000_mean"].get<double>(),
              0.05 + 3.0 * with_triangles["error"]["ciede2000_mean_standard_error"].get<double>());
}

TEST(TradeoffCommand, ErrorsAreTheSameForAnyNumberOfThreads) {
    const Workplace place;
    place.file("scene.toml", kScene);
    const auto errors = [&](const char* threads) {
        Json result = place.json(with(kQuick, {"--rungs", "thin-lens", "--threads", threads}));
        for (Json& rung : result["rungs"]) {
            rung.erase("cost");  // times
            rung.erase("pareto");
            rung["error"].erase("ciede2000_mean_at_equal_time");
            rung["error"].erase("flip_at_equal_time");
        }
        return result;
    };
    EXPECT_EQ(errors("1"), errors("2"));
}

TEST(TradeoffCommand, RefusesWhatItCannotHoldAgainstALens) {
    const Workplace place;
    place.file("scene.toml", kScene);
    const Outcome unknown = place.run(with(kQuick, {"--rungs", "thick-lens"}));
    EXPECT_EQ(unknown.status, 2);
    EXPECT_NE(unknown.err.find("thick-lens"), std::string::npos);
    std::string no_lens = kScene;
    no_lens.replace(no_lens.find("lens = \"tessar\""), 15, "model = \"thin-lens\"\nfocal_length_mm = 50.0");
    place.file("no_lens.toml", no_lens);
    const Outcome bare = place.run({"tradeoff", "no_lens.toml"});
    EXPECT_EQ(bare.status, 2);
    EXPECT_NE(bare.err.find("no_lens.toml"), std::string::npos);
    EXPECT_NE(bare.err.find("focal length in the place of a lens"), std::string::npos);
    EXPECT_EQ(place.run({"tradeoff", "scene.toml", "--seeds", "1"}).status, 2);
    EXPECT_EQ(place.run({"tradeoff", "missing.toml"}).status, 2);
}

TEST(PlanCommand, ReportsWhatTheContractSays) {
    const Workplace place;
    place.file("scene.toml", kScene);
    const Json plan = place.json({"plan", "scene.toml", "--tolerance", "0.5px,0.02ev,1de"});
    EXPECT_EQ(plan["tolerance"], Json({{"px", 0.5}, {"ev", 0.02}, {"ciede2000", 1.0}}));
    EXPECT_TRUE(plan["model"].is_string());
    EXPECT_GT(plan["probe_seconds"].get<double>(), 0.0);
    std::vector<std::string> effects;
    for (const Json& effect : plan["effects"]) {
        effects.push_back(effect["effect"]);
        for (const char* key : {"px", "ev", "ciede2000"}) {
            EXPECT_GE(effect["contribution"][key].get<double>(), 0.0);
            EXPECT_GE(effect["standard_error"][key].get<double>(), 0.0);
        }
        EXPECT_TRUE(effect["decision"] == "model" || effect["decision"] == "leave-out");
        EXPECT_TRUE(effect["saves_percent"].is_number());
        EXPECT_FALSE(effect["why"].get<std::string>().empty());
    }
    for (const char* name : {"distortion", "defocus", "diffraction", "vignetting", "ghosts", "wavelengths"}) {
        EXPECT_TRUE(std::ranges::count(effects, name) == 1) << name;
    }
}

TEST(PlanCommand, ARenderActsOnIt) {
    const Workplace place;
    place.file("scene.toml", kScene);
    const Json result = place.json(
        {"render", "scene.toml", "--model", "auto", "--tolerance", "1000px", "--spp", "1", "-o", "auto.exr"});
    EXPECT_EQ(result["model"], "pinhole");
    EXPECT_EQ(result["plan"]["model"], "pinhole");
    EXPECT_NE(place.content("auto.exr").find("lensproof:plan"), std::string::npos);
}

TEST(PlanCommand, APlannedPictureHasTheSameBytesInEveryRun) {
    const Workplace place;
    place.file("scene.toml", kScene);
    for (const char* threads : {"1", "2"}) {
        const Outcome outcome = place.run({"render", "scene.toml", "--model", "auto", "--tolerance", "2px,0.2ev,5de",
                                           "--spp", "1", "--threads", threads, "-o", std::string(threads) + ".exr"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
    }
    EXPECT_EQ(place.content("1.exr"), place.content("2.exr"));
}

// Bare glass's ghosts of an evenly lit wall are smooth: they take a sixteenth of the samples, and have the light that
// they have by all of them, within four of its errors (eight seeds scatter by 8 % with 2 samples, by 2 % with 32).
// With --noise, which judges pixels before they are spread, they take as many as it asks for.
TEST(PlanCommand, SmoothLightTakesFewerSamples) {
    const Workplace place;
    std::string scene = kScene;
    scene.replace(scene.find("pixels = [600, 400]"), 19, "pixels = [150, 100]");
    place.file("scene.toml", scene);
    const Json planned = place.json({"render", "scene.toml", "--model", "auto", "--tolerance", "0.5px,0.02ev,1de",
                                     "--spp", "32", "-o", "auto.exr"});
    ASSERT_EQ(planned["plan"]["passes"], Json({"ghosts"}));
    const Json& smooth = planned["plan"]["smooth"]["ghosts"];
    EXPECT_EQ(smooth["fewer_samples"], 16);
    EXPECT_GE(smooth["sigma_px"], 2.0);
    const Json all =
        place.json({"render", "scene.toml", "--passes", "straight,ghosts", "--spp", "32", "-o", "all.exr"});
    EXPECT_EQ(planned["passes"][0]["samples_per_pixel"], 32.0);
    EXPECT_EQ(planned["passes"][1]["samples_per_pixel"], 2.0);
    EXPECT_EQ(all["passes"][1]["samples_per_pixel"], 32.0);
    const double light = all["passes"][1]["light"].get<double>();
    EXPECT_NEAR(planned["passes"][1]["light"].get<double>(), light, 0.33 * light);
    EXPECT_LT(planned["relative_error"].get<double>(), all["relative_error"].get<double>());
    scene.replace(scene.find("pixels = [150, 100]"), 19, "pixels = [45, 30]");
    place.file("small.toml", scene);
    const Json judged = place.json({"render", "small.toml", "--model", "auto", "--tolerance", "0.5px,0.02ev,1de",
                                    "--noise", "2", "--spp", "256", "-o", "noise.exr"});
    EXPECT_EQ(judged["run"]["ended_by"], "noise");
    EXPECT_LT(judged["passes"][1]["samples_per_pixel"], 256.0);
}

TEST(PlanCommand, RefusesTolerancesThatSayNothing) {
    const Workplace place;
    place.file("scene.toml", kScene);
    for (const char* wrong : {"0.5", "-1px", "1px,1px", ""}) {
        const Outcome outcome = place.run({"plan", "scene.toml", "--tolerance", wrong});
        EXPECT_EQ(outcome.status, 2) << wrong;
        EXPECT_NE(outcome.err.find("--tolerance"), std::string::npos) << wrong;
    }
    EXPECT_EQ(place.run({"plan", "scene.toml"}).status, 2);
    EXPECT_EQ(place.run({"render", "scene.toml", "--model", "auto", "-o", "a.exr"}).status, 2);
    EXPECT_EQ(place.run({"render", "scene.toml", "--tolerance", "1px", "-o", "a.exr"}).status, 2);
    EXPECT_EQ(
        place
            .run({"render", "scene.toml", "--model", "auto", "--tolerance", "1px", "--passes", "imaged", "-o", "a.exr"})
            .status,
        2);
    EXPECT_FALSE(place.has("a.exr"));
}

}  // namespace lensproof::tradeoff_command_test
