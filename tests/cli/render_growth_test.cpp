// tests/cli/render_growth_test.cpp — renders that grow: until when, through interruptions, in passing view.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "engine/formats/image/denoise.h"
#include "engine/formats/image/image.h"
#include "engine/render/film/film_exr.h"
#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::render_growth_test {

using Json = nlohmann::json;

/// 64 × 48 pixels, 12 tiles; 2500 samples a pixel take about half a second of a core.
std::string growing_scene() {
    return with(small_scene(), "[8, 6]", "[64, 48]");
}

constexpr const char* kSamples = "2500";

/// The machine-readable result of a render that went well.
Json rendered(const Workplace& place, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"render", "scene.toml"});
    return place.json(arguments);
}

/// Waits until `file` is there, or the program has ended.
void wait_for(const std::filesystem::path& file, RunningProgram& program) {
    while (!program.has_ended() && !std::filesystem::exists(file)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

// A process that is killed, again and again, while it writes checkpoints all the time; then the render goes on to its
// end. The EXR has every byte of that of a render that nobody touched.
TEST(RenderGrowth, SurvivesKill9WithEveryByte) {
    const Workplace place;
    place.file("scene.toml", growing_scene());
    rendered(place, {"--spp", kSamples, "-o", "whole.exr"});
    const std::vector<std::string> killed = {
        "render", "scene.toml", "--spp", kSamples, "-o", "killed.exr", "--checkpoint", "state", "--checkpoint-interval",
        "0.001",  "--threads",  "1"};
    int kills = 0;
    for (int wait_ms = 0; kills < 6; wait_ms = 70 + 2 * wait_ms / 3) {
        RunningProgram program(killed, place.path());
        wait_for(place.path() / "state", program);  // there from the second time on
        std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
        if (program.has_ended()) {
            break;
        }
        program.send(SIGKILL);
        EXPECT_EQ(program.wait(), -SIGKILL);
        ++kills;
    }
    EXPECT_GT(kills, 0);
    EXPECT_FALSE(place.has("killed.exr"));
    EXPECT_EQ(place.run(killed).status, 0);
    EXPECT_EQ(place.content("killed.exr"), place.content("whole.exr"));
    EXPECT_EQ(place.content("killed.png"), place.content("whole.png"));
    for (const std::string& name : place.names()) {
        EXPECT_FALSE(says(name, ".part")) << name << ": what killed processes left is gone";
    }
}

// SIGTERM and Ctrl-C: status 3, no picture of the name asked for, and a checkpoint to go on from, though none was asked
// for. The preview says that it has begun.
TEST(RenderGrowth, EndsOnASignalWithACheckpoint) {
    const Workplace place;
    place.file("scene.toml", growing_scene());
    for (const int signal : {SIGTERM, SIGINT}) {
        std::filesystem::remove(place.path() / "now.png");
        RunningProgram program(
            {"render", "scene.toml", "--spp", kSamples, "-o", "cut.exr", "--threads", "1", "--preview", "now.png"},
            place.path());
        wait_for(place.path() / "now.png", program);
        program.send(signal);
        EXPECT_EQ(program.wait(), 3);
        EXPECT_FALSE(place.has("cut.exr"));
        ASSERT_TRUE(place.has("cut.exr.checkpoint"));
    }
    rendered(place, {"--spp", kSamples, "-o", "whole.exr"});
    rendered(place, {"--spp", kSamples, "-o", "cut.exr", "--checkpoint", "cut.exr.checkpoint"});
    EXPECT_EQ(place.content("cut.exr"), place.content("whole.exr"));
}

// What is finished goes on to more samples, and is then what it would have been at once.
TEST(RenderGrowth, GoesOnToMoreSamples) {
    const Workplace place;
    place.file("scene.toml", growing_scene());
    rendered(place, {"--spp", "96", "-o", "whole.exr"});
    rendered(place, {"--spp", "32", "-o", "part.exr", "--checkpoint", "state"});
    EXPECT_NE(place.content("part.exr"), place.content("whole.exr"));
    rendered(place, {"--spp", "96", "-o", "part.exr", "--checkpoint", "state"});
    EXPECT_EQ(place.content("part.exr"), place.content("whole.exr"));
}

TEST(RenderGrowth, EndsInTime) {
    const Workplace place;
    place.file("scene.toml", growing_scene());
    const Json result = rendered(place, {"--time", "0.2", "-o", "out.exr"});
    EXPECT_GT(result["samples_per_pixel"], 0.0);
    EXPECT_LT(result["samples_per_pixel"], 1 << 20);
    EXPECT_TRUE(place.has("out.exr"));
    EXPECT_EQ(result["run"]["ended_by"], "time");
    EXPECT_GE(result["run"]["wall_seconds"], 0.2);
}

// How long, how fast, and why no longer. 64 × 48 pixels of 32 samples each are 98304; a processor's time is no more
// than the threads had.
TEST(RenderGrowth, SaysHowLongItTookAndWhyItEnded) {
    const Workplace place;
    place.file("scene.toml", growing_scene());
    const Json run =
        rendered(place, {"--spp", "32", "-o", "out.exr", "--threads", "1", "--checkpoint", "state"})["run"];
    EXPECT_EQ(run["ended_by"], "samples");
    EXPECT_EQ(run["samples"], 98304);
    const double wall_s = run["wall_seconds"];
    EXPECT_GT(wall_s, 0.0);
    EXPECT_NEAR(run["samples_per_second"].get<double>() * wall_s, 98304.0, 1e-3);
    EXPECT_GT(run["cpu_seconds"], 0.0);
    EXPECT_LT(run["cpu_seconds"].get<double>(), wall_s + 0.1);  // of the main thread, which waits and looks
    // From its checkpoint there is nothing more to do.
    EXPECT_EQ(rendered(place, {"--spp", "32", "-o", "out.exr", "--checkpoint", "state"})["run"]["samples"], 0);
    // An end by the noise says so; where the samples run out first, it says that.
    EXPECT_EQ(rendered(place, {"--noise", "0.5", "-o", "out.exr"})["run"]["ended_by"], "noise");
    EXPECT_EQ(rendered(place, {"--noise", "1e-6", "--spp", "64", "-o", "out.exr"})["run"]["ended_by"], "samples");
}

// One that a signal ended has a result, too: what there is, and where it goes on.
TEST(RenderGrowth, AnInterruptedRenderSaysSoInItsJson) {
    const Workplace place;
    place.file("scene.toml", growing_scene());
    RunningProgram program(
        {"render", "scene.toml", "--spp", "1000000", "-o", "out.exr", "--preview", "now.png", "--json", "out.json"},
        place.path());
    wait_for(place.path() / "now.png", program);
    program.send(SIGTERM);
    EXPECT_EQ(program.wait(), 3);
    const Json result = Json::parse(place.content("out.json"));
    EXPECT_EQ(result["run"]["ended_by"], "interrupted");
    EXPECT_EQ(result["checkpoint"], "out.exr.checkpoint");
    EXPECT_FALSE(result.contains("exr"));
    // The picture so far: as many samples as are said, and no shard.
    EXPECT_EQ(result["so_far"]["exr"], "out.exr.checkpoint.exr");
    EXPECT_TRUE(place.has("out.exr.checkpoint.png"));
    const render::FilmFile so_far = render::read_film_exr(place.path() / "out.exr.checkpoint.exr");
    double samples = 0.0;
    const render::Film& film = so_far.films.at(0).film;
    for (int y = 0; y < film.height(); ++y) {
        for (int x = 0; x < film.width(); ++x) {
            samples += film.counts(x, y).samples;
        }
    }
    EXPECT_NEAR(samples / (film.width() * film.height()), result["samples_per_pixel"].get<double>(), 1e-9);
    EXPECT_EQ(so_far.notes.metadata.at("lensproof:interruptedAfter"),
              fmt::format("{:.1f} samples a pixel", result["samples_per_pixel"].get<double>()));
}

// Whoever ends a shard, a queue say, has little time, and nobody looks at a part's picture.
TEST(RenderGrowth, AnInterruptedShardLeavesItsCheckpointAlone) {
    const Workplace place;
    place.file("scene.toml", growing_scene());
    RunningProgram program(
        {"render", "scene.toml", "--spp", "1000000", "--shard", "1/2", "-o", "part.exr", "--preview", "now.png"},
        place.path());
    wait_for(place.path() / "now.png", program);
    program.send(SIGTERM);
    EXPECT_EQ(program.wait(), 3);
    EXPECT_TRUE(place.has("part.exr.checkpoint"));
    EXPECT_FALSE(place.has("part.exr.checkpoint.exr"));
    EXPECT_FALSE(place.has("part.exr.checkpoint.png"));
}

// A flat field, where all tiles are alike: the error that was asked for, and less where less was.
TEST(RenderGrowth, EndsWhereTheNoiseIsLow) {
    const Workplace place;
    std::string flat = with(growing_scene(), "\"checkerboard\"", "\"flat-field\"");
    flat = with(flat, "squares = [12, 9]\nsquare_mm = 560.0\n", "");
    place.file("scene.toml", with(flat, "[pose]\ndistance_mm = 10000.0\n", ""));
    const Json coarse = rendered(place, {"--noise", "0.01", "-o", "coarse.exr"});
    const Json fine = rendered(place, {"--noise", "0.005", "-o", "fine.exr"});
    EXPECT_LE(coarse["relative_error"], 0.01);
    EXPECT_LE(fine["relative_error"], 0.005);
    EXPECT_GT(fine["relative_error"], 0.0025);
    EXPECT_GT(fine["samples_per_pixel"], coarse["samples_per_pixel"]);
    // Each shard of four has twice the error.
    const Json shard = rendered(place, {"--noise", "0.005", "--shard", "3/4", "-o", "shard.exr"});
    EXPECT_LE(shard["relative_error"], 0.01);
    EXPECT_LT(shard["samples_per_pixel"], fine["samples_per_pixel"]);
    EXPECT_EQ(shard["shard"], "3/4");
}

// The preview is there long before the end, and a whole picture whenever it is looked at.
TEST(RenderGrowth, ShowsItselfWhileItGrows) {
    const Workplace place;
    place.file("scene.toml", growing_scene());
    RunningProgram program({"render", "scene.toml", "--spp", "1000000", "-o", "out.exr", "--preview", "now.png"},
                           place.path());
    for (int i = 0; i < 600 && !place.has("now.png"); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    EXPECT_FALSE(program.has_ended());
    const std::string png = place.content("now.png");
    EXPECT_TRUE(png.starts_with("\x89PNG")) << "it begins";
    EXPECT_TRUE(says(png, "IEND")) << "and ends";
    EXPECT_FALSE(place.has("out.exr"));
}

// A wider filter spreads edges; the picture keeps its light: over 64 × 48 pixels and 64 samples the means of two
// renders differ by much less than 2 %.
TEST(RenderGrowth, FiltersPixelsAsAsked) {
    const Workplace place;
    place.file("scene.toml", growing_scene());
    for (const char* filter : {"box", "mitchell", "gaussian"}) {
        rendered(place, {"--filter", filter, "--features", "-o", std::string(filter) + ".exr"});
    }
    EXPECT_NE(place.content("box.exr"), place.content("gaussian.exr"));
    EXPECT_EQ(place.run({"compare", "box.exr", "mitchell.exr", "--rms-limit", "0.3"}).status, 0);
    EXPECT_EQ(place.run({"compare", "box.exr", "mitchell.exr", "--rms-limit", "1e-6"}).status, 1);
    EXPECT_TRUE(says(place.content("box.exr"), "albedo.R"));
}

TEST(RenderGrowth, RefusesOptionsThatMakeNoSense) {
    const Workplace place;
    place.file("scene.toml", small_scene());
    place.file("folder/inside", "");
    place.file("text", "no checkpoint");
    const std::vector<std::vector<std::string>> bad = {{"--samples", "0"},
                                                       {"--samples", "-1"},
                                                       {"--samples", "1e9"},
                                                       {"--samples", "nan"},
                                                       {"--time", "nan"},
                                                       {"--time", "0"},
                                                       {"--time", "-1"},
                                                       {"--time", "inf"},
                                                       {"--noise", "nan"},
                                                       {"--noise", "0"},
                                                       {"--noise", "-0.1"},
                                                       {"--noise", "1 %"},
                                                       {"--filter", "lanczos"},
                                                       {"--shard", "3/2"},
                                                       {"--shard", "0/0"},
                                                       {"--shard", "0/2"},
                                                       {"--shard", "-1/2"},
                                                       {"--shard", "1/"},
                                                       {"--shard", "/2"},
                                                       {"--shard", "1.5/2"},
                                                       {"--shard", "1/2/3"},
                                                       {"--shard", "1-2/3"},
                                                       {"--shard", "1/99999"},
                                                       {"--shard", "1/5"},
                                                       {"--preview", "now.jpg"},
                                                       {"--preview", "folder/"},
                                                       {"--checkpoint", "folder"},
                                                       {"--checkpoint", "text"},
                                                       {"--checkpoint-interval", "nan"},
                                                       {"--checkpoint-interval", "-1"}};
    for (const std::vector<std::string>& option : bad) {
        SCOPED_TRACE(option[0] + " " + option[1]);
        std::vector<std::string> arguments = {"render", "scene.toml", "-o", "out.exr"};
        arguments.insert(arguments.end(), option.begin(), option.end());
        const bool is_about_a_file = option[0] == "--checkpoint" || option[1] == "folder/";
        expect_refused(place, arguments, {is_about_a_file ? option[1] : option[0]});
    }
}

TEST(RenderGrowth, RefusesACheckpointOfAnotherRender) {
    const Workplace place;
    place.file("scene.toml", small_scene());
    rendered(place, {"--checkpoint", "state", "-o", "out.exr"});
    const auto with_more = [](std::vector<std::string> more) {
        more.insert(more.begin(), {"render", "scene.toml", "-o", "out.exr", "--checkpoint", "state"});
        return more;
    };
    expect_refused(place, with_more({"--seed", "1"}), {"state", "seed is 0, expected 1"});
    expect_refused(place, with_more({"--filter", "tent"}), {"state", "settings", "tent"});
    expect_refused(place, with_more({"--spp", "2"}), {"state", "4 samples a pixel already, expected 2"});
    expect_refused(place, with_more({"--spp", "32", "--shard", "2/2"}), {"state", "samples begin"});
    place.file("scene.toml", with(small_scene(), "f_number = 8.0", "f_number = 4.0"));
    expect_refused(place, with_more({}), {"state", "scene"});
    place.file("scene.toml", small_scene());
    std::string bytes = place.content("state");
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    place.file("state", bytes);
    expect_refused(place, with_more({}), {"state", "damaged"});
}

// One part of half floats with the picture's numbers to their 11 bits, and what else the picture's file says; what is
// larger than any half is said, and the largest.
TEST(RenderGrowth, WritesHalfFloatsOnRequest) {
    const Workplace place;
    place.file("scene.toml", growing_scene());
    const Json result = rendered(place, {"--spp", "16", "-o", "out.exr", "--half", "half.exr"});
    EXPECT_EQ(result["half"], "half.exr");
    EXPECT_FALSE(result.contains("half_clipped"));
    const auto input = OIIO::ImageInput::open((place.path() / "half.exr").string());
    ASSERT_TRUE(input);
    EXPECT_EQ(input->spec().format, OIIO::TypeDesc::HALF);
    EXPECT_EQ(input->spec().nchannels, 3);
    EXPECT_FALSE(input->seek_subimage(1, 0)) << "a second part";
    const formats::Image half = formats::read_image(place.path() / "half.exr");
    const formats::Image whole = formats::read_image(place.path() / "out.exr");
    ASSERT_EQ(half.pixels.size(), whole.pixels.size());
    for (std::size_t i = 0; i < half.pixels.size(); ++i) {
        EXPECT_NEAR(half.pixels[i], whole.pixels[i], std::abs(whole.pixels[i]) * 0x1p-11F + 0x1p-25F);
    }
    EXPECT_EQ(half.metadata.at("lensproof:samplesPerPixel"), "16");
    place.file("bright.toml", with(growing_scene(), "iso = 100", "iso = 100000000"));
    const Outcome bright = place.run(
        {"render", "bright.toml", "--spp", "16", "-o", "bright.exr", "--half", "b.exr", "--json", "bright.json"});
    ASSERT_EQ(bright.status, 0) << bright.err;
    EXPECT_GT(Json::parse(place.content("bright.json"))["half_clipped"], 0);
    EXPECT_TRUE(says(bright.err, "larger than a half float's 65504"));
    for (const float value : formats::read_image(place.path() / "b.exr").pixels) {
        EXPECT_LE(std::abs(value), 65504.0F);
    }
    expect_refused(place, {"render", "scene.toml", "-o", "out.exr", "--half", "out.exr"}, {"--half", "out.exr"});
    expect_refused(place, {"render", "scene.toml", "-o", "out.exr", "--half", "half.png"}, {"--half", "half.png"});
}

// Where the program was built with a denoiser there is a second picture with less noise, of the same light within 2 %
// (it is trained to keep it), and the first is as it would be without; else the option is refused.
TEST(RenderGrowth, DenoisesOnlyOnRequest) {
    const Workplace place;
    place.file("scene.toml", growing_scene());
    const std::vector<std::string> plain = {"render", "scene.toml", "--spp", "16", "-o", "out.exr"};
    ASSERT_EQ(place.run(plain).status, 0);
    const std::string picture = place.content("out.exr");
    std::vector<std::string> more = plain;
    more.emplace_back("--denoise");
    if (!formats::denoiser()) {
        expect_refused(place, more, {"--denoise", "built without Intel Open Image Denoise"});
        return;
    }
    const Json result = place.json(more);
    EXPECT_EQ(place.content("out.exr"), picture);
    EXPECT_EQ(result["denoised"]["exr"], "out.denoised.exr");
    const formats::Image clean = formats::read_image(place.path() / "out.denoised.exr");
    const formats::Image noisy = formats::read_image(place.path() / "out.exr");
    EXPECT_TRUE(says(clean.metadata.at("lensproof:denoised"), "Open Image Denoise"));
    double light = 0.0;
    double light_before = 0.0;
    for (std::size_t i = 0; i < clean.pixels.size(); ++i) {
        light += clean.pixels[i];
        light_before += noisy.pixels[i];
    }
    EXPECT_NEAR(light, light_before, 0.02 * light_before);
    EXPECT_NE(clean.pixels, noisy.pixels);
}

}  // namespace lensproof::render_growth_test
