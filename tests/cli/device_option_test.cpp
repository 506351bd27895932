// tests/cli/device_option_test.cpp — `--device`: whoever traces, the bytes are the same.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/cli/program.h"
#include "tests/cli/trace_table.h"
#include "tests/complaint.h"

namespace lensproof::device_option_test {

/// Also on machines that have a GPU.
const Variable kNoGpu("CUDA_VISIBLE_DEVICES", "");

/// Rays of many wavelengths, over all of a Tessar's front and beyond.
std::string many_rays(int count) {
    std::string rays = kRayHeader;
    for (int i = 0; i < count; ++i) {
        rays += fmt::format("r{},{},{},-10,{},{},1,{}\n", i, 0.05 * (i % 600) - 15.0, 0.01 * (i % 600),
                            0.0005 * (i % 100), -0.001 * (i % 37), 420.0 + i % 150);
    }
    return rays;
}

TEST(DeviceOption, TracesToTheSameBytes) {
    const Workplace place;
    place.file("rays.csv", many_rays(600));
    for (const std::vector<std::string>& more :
         {std::vector<std::string>{},
          {"--precision", "float"},
          {"--no-clip"},
          {"--sequence", "2,1"},
          {"--polarised"},
          {"--coating", "broadband"},
          {"--sequence", "image,8", "--sensor-reflectance", "0.1", "--no-clip"}}) {
        const auto traced = [&](const std::string& device) {
            std::vector<std::string> arguments = {"trace",    "tessar", "--rays", "rays.csv",
                                                  "--device", device,   "--json", "all.json"};
            arguments.insert(arguments.end(), more.begin(), more.end());
            const Outcome outcome = place.run(arguments);
            EXPECT_EQ(outcome.status, 0) << outcome.err;
            return outcome.out + place.content("all.json");
        };
        EXPECT_EQ(traced("stand-in"), traced("cpu")) << fmt::format("{}", fmt::join(more, " "));
    }
}

// A device is sent 16384 at a time.
TEST(DeviceOption, TracesMoreRaysThanGoTogether) {
    const Workplace place;
    place.file("rays.csv", many_rays(17000));
    const auto traced = [&](const std::string& device) {
        return place.run({"trace", "tessar", "--rays", "rays.csv", "--device", device}).out;
    };
    const std::string usual = traced("cpu");
    EXPECT_TRUE(says(usual.substr(usual.size() - 200), "r16999,"));
    EXPECT_TRUE(traced("stand-in") == usual);
}

TEST(DeviceOption, FollowsRaysInReverseToo) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + "a,3,1,120,-0.03,0.01,-1,550\nb,3,1,120,-0.3,0.01,-1,450\n");
    const auto traced = [&](const std::string& device) {
        return place.run({"trace", "tessar", "--rays", "rays.csv", "--reverse", "--device", device}).out;
    };
    EXPECT_EQ(traced("stand-in"), traced("cpu"));
    EXPECT_GT(cells_of(traced("cpu")).size(), 9U);
}

TEST(DeviceOption, RendersToTheSameBytes) {
    const Workplace place;
    place.file("chart.toml", small_scene());
    const auto rendered = [&](const std::string& device, const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments = {"render", "chart.toml", "-o", "a.exr", "--device", device};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = place.run(arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return place.content("a.exr") + outcome.err;
    };
    EXPECT_EQ(rendered("stand-in"), rendered("cpu"));
    EXPECT_EQ(rendered("stand-in", {"--model", "exact-float", "--spp", "3", "--threads", "2"}),
              rendered("cpu", {"--model", "exact-float", "--spp", "3", "--threads", "2"}));
    // What a device cannot do is told, and done.
    EXPECT_TRUE(says(rendered("stand-in", {"--model", "thin-lens"}), "not on the device"));
    EXPECT_TRUE(says(rendered("stand-in", {"--filter", "gaussian"}), "the filter is gaussian"));
}

TEST(DeviceOption, FindsTheSameGhosts) {
    const Workplace place;
    const auto found = [&](const std::string& device) {
        const Outcome outcome = place.run({"ghosts", "tessar", "--source-deg", "10", "--image", "ghosts.exr",
                                           "--pixels", "120,120", "--json", "-", "--device", device});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return outcome.out + place.content("ghosts.exr");
    };
    EXPECT_EQ(found("stand-in"), found("cpu"));
}

TEST(DeviceOption, RunsToTheSameReport) {
    const Workplace place;
    place.file("e.toml", small_experiment());
    const auto report = [&](const std::string& device) {
        const Outcome outcome = place.run({"run", "e.toml", "-o", device, "--device", device});
        EXPECT_EQ(outcome.err, "");
        return place.content(device + "/report.json");
    };
    const std::string usual = report("cpu");
    EXPECT_GT(usual.size(), 1000U);
    EXPECT_EQ(report("stand-in"), usual);
}

// `auto` goes on without one and says so in a line; `cuda` says why not, and has done nothing.
TEST(DeviceOption, SaysThatThereIsNoGpu) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + kAxialRay);
    place.file("chart.toml", small_scene());
    place.file("e.toml", small_experiment());
    const Outcome usual = place.run({"trace", "tessar", "--rays", "rays.csv"});
    const Outcome automatic = place.run({"trace", "tessar", "--rays", "rays.csv", "--device", "auto"});
    EXPECT_EQ(automatic.status, 0);
    EXPECT_EQ(automatic.out, usual.out);
    EXPECT_TRUE(says(automatic.err, "lensproof: no GPU, so the processors do it: "));
    EXPECT_EQ(std::ranges::count(automatic.err, '\n'), 1);
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"trace", "tessar", "--rays", "rays.csv", "-o", "a.csv"},
          {"render", "chart.toml", "-o", "a.exr"},
          {"ghosts", "tessar", "--json", "ghosts.json"},
          {"run", "e.toml", "-o", "out"}}) {
        std::vector<std::string> on_gpu = arguments;
        on_gpu.insert(on_gpu.end(), {"--device", "cuda"});
        expect_refused(place, on_gpu, {"--device is \"cuda\", but"});
    }
    expect_refused(place, {"trace", "tessar", "--rays", "rays.csv", "--device", "gpu"},
                   {"--device", "gpu", "stand-in"});
}

TEST(DeviceOption, HasNoExtendedPrecision) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + kAxialRay);
    const auto traced = [&](const std::string& device) {
        return place.run({"trace", "tessar", "--rays", "rays.csv", "--precision", "extended", "--device", device});
    };
    EXPECT_EQ(traced("stand-in").out, traced("cpu").out);
    EXPECT_TRUE(says(traced("stand-in").err, "no GPU has extended precision"));
}

}  // namespace lensproof::device_option_test
