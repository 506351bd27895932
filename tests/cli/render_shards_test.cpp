// tests/cli/render_shards_test.cpp — `render --shard` and `merge`.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::render_shards_test {

using Json = nlohmann::json;

/// A place with the scene's three shards, part1.exr to part3.exr, and whole.exr.
class Shards {
  public:
    Shards() {
        place_.file("scene.toml", small_scene());
        for (const char* index : {"1", "2", "3"}) {
            render({"--shard", std::string(index) + "/3", "-o", std::string("part") + index + ".exr"});
        }
        render({"-o", "whole.exr"});
    }

    void render(std::vector<std::string> more) const {
        more.insert(more.begin(), {"render", "scene.toml", "--spp", "200"});
        const Outcome outcome = place_.run(more);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
    }

    [[nodiscard]] Outcome merge(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "merge");
        return place_.run(arguments);
    }

    void expect_no_merge(std::vector<std::string> arguments, const std::vector<std::string>& words) const {
        arguments.insert(arguments.begin(), "merge");
        expect_refused(place_, arguments, words);
    }

    [[nodiscard]] const Workplace& place() const { return place_; }

  private:
    Workplace place_;
};

TEST(Merge, AddsUpToTheWholeInAnyOrder) {
    const Shards shards;
    const Json merged = shards.place().json({"merge", "part3.exr", "part1.exr", "part2.exr", "-o", "sum.exr"});
    EXPECT_EQ(merged["shards"], (Json{1, 2, 3}));
    ASSERT_EQ(shards.merge({"part1.exr", "part2.exr", "part3.exr", "-o", "same.exr"}).status, 0);
    EXPECT_EQ(shards.place().content("sum.exr"), shards.place().content("same.exr"));
    // 1e-6 of values of size 1.
    EXPECT_EQ(shards.place().run({"compare", "sum.exr", "whole.exr", "--rms-limit", "1e-6"}).status, 0);
    EXPECT_EQ(shards.place().run({"compare", "part1.exr", "whole.exr", "--rms-limit", "1e-6"}).status, 1);
}

// Some of the shards, if that is wanted; the outcome is a shard of its own, and with the rest makes the whole, byte by
// byte, though its numbers went through a file once more: sums of floats' sums may differ in the last bit, so by 1e-6.
TEST(Merge, TakesSomeShardsWhereAsked) {
    const Shards shards;
    shards.expect_no_merge({"part3.exr", "part1.exr", "-o", "sum.exr"}, {"missing: 2", "--partial"});
    const Json merged = shards.place().json({"merge", "part3.exr", "part1.exr", "-o", "some.exr", "--partial"});
    EXPECT_EQ(merged["missing"], Json::array({2}));
    shards.expect_no_merge({"some.exr", "part3.exr", "-o", "sum.exr"}, {"part3.exr", "shard 3/3", "some.exr"});
    shards.expect_no_merge({"some.exr", "-o", "sum.exr"}, {"missing: 2"});
    ASSERT_EQ(shards.merge({"some.exr", "part2.exr", "-o", "sum.exr"}).status, 0);
    EXPECT_EQ(shards.place().run({"compare", "sum.exr", "whole.exr", "--rms-limit", "1e-6"}).status, 0);
    shards.expect_no_merge({"sum.exr", "part2.exr", "-o", "more.exr"}, {"sum.exr", "not a shard"});
}

TEST(Merge, RefusesWhatDoesNotBelongTogether) {
    const Shards shards;
    const Workplace& place = shards.place();
    const auto expect_other = [&](const std::vector<std::string>& options, const std::string& what) {
        std::vector<std::string> arguments = {"render", "other.toml", "-o", "other.exr"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        EXPECT_EQ(place.run(arguments).status, 0);
        shards.expect_no_merge({"part1.exr", "other.exr", "part3.exr", "-o", "sum.exr"}, {"other.exr", what});
    };
    place.file("other.toml", small_scene());
    expect_other({"--spp", "200", "--shard", "2/3", "--seed", "1"}, "its seed is 1, expected 0");
    expect_other({"--spp", "200", "--shard", "2/3", "--filter", "tent"}, "settings");
    expect_other({"--spp", "100", "--shard", "2/3"}, "samplesPerPixel is 100, expected 200");
    expect_other({"--spp", "200", "--shard", "2/4"}, "one of 4 shards");
    place.file("other.toml", with(small_scene(), "[12, 9]", "[10, 9]"));
    expect_other({"--spp", "200", "--shard", "2/3"}, "scene");
    place.file("other.toml", with(small_scene(), "\"tessar\"", "\"petzval\""));
    expect_other({"--spp", "200", "--shard", "2/3"}, "lens");
    shards.expect_no_merge({"part1.exr", "part1.exr", "part2.exr", "part3.exr", "-o", "sum.exr"}, {"shard 1/3"});
    shards.expect_no_merge({"part1.exr", "part2.exr", "whole.exr", "-o", "sum.exr"}, {"whole.exr", "not a shard"});
    shards.expect_no_merge({"part1.exr", "scene.toml", "-o", "sum.exr"}, {"scene.toml", "OpenEXR"});
    shards.expect_no_merge({"part1.exr", "missing.exr", "-o", "sum.exr"}, {"missing.exr", "no such file"});
    shards.expect_no_merge({"part1.exr", "part2.exr", "part3.exr", "-o", "sum.tif"}, {"--output", ".exr"});
    shards.expect_no_merge({"part1.exr", "part2.exr", "part3.exr"}, {"--output"});
    const std::string good = place.content("part2.exr");
    place.file("cut.exr", good.substr(0, good.size() / 2));
    shards.expect_no_merge({"part1.exr", "cut.exr", "part3.exr", "-o", "sum.exr"}, {"cut.exr"});
}

// A lens file may change under the same scene: its rays are compared, not its name.
TEST(Merge, KnowsALensByItsSurfaces) {
    const Workplace place;
    place.file("scene.toml", with(small_scene(), "\"tessar\"", "\"singlet.toml\""));
    place.file("singlet.toml", kSinglet);
    EXPECT_EQ(place.run({"render", "scene.toml", "--spp", "32", "--shard", "1/2", "-o", "a.exr"}).status, 0);
    place.file("singlet.toml", with(kSinglet, "radius_mm =  50.0", "radius_mm =  50.1"));
    EXPECT_EQ(place.run({"render", "scene.toml", "--spp", "32", "--shard", "2/2", "-o", "b.exr"}).status, 0);
    expect_refused(place, {"merge", "a.exr", "b.exr", "-o", "sum.exr"},
                   {"b.exr: is of another render than a.exr: its lens is"});
}

TEST(Shard, IsNamedByItsNumbersWhereNoNameIsGiven) {
    const Workplace place;
    place.file("scene.toml", small_scene());
    EXPECT_EQ(place.run({"render", "scene.toml", "--spp", "48", "--shard", "2/3"}).status, 0);
    EXPECT_TRUE(place.has("scene.shard-2-of-3.exr"));
}

// Blocks that are cut would make the variances of the sum several times the whole's.
TEST(Shard, HasWholeBlocks) {
    const Workplace place;
    place.file("scene.toml", small_scene());
    expect_refused(place, {"render", "scene.toml", "--spp", "48", "--shard", "2/4", "-o", "a.exr"},
                   {"--shard is \"2/4\": 48 samples a pixel are dealt in blocks of 16, expected i/n with n ≤ 3"});
}

}  // namespace lensproof::render_shards_test
