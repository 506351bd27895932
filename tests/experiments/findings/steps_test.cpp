// Steps of a run: done once, until something that they follow from changes.
#include "experiments/findings/steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "engine/base/toml.h"
#include "engine/base/write_file.h"
#include "engine/formats/image/image_json.h"
#include "tests/test_folder.h"

namespace lensproof::findings::steps_test {

namespace fs = std::filesystem;

struct Result {
    double number = 0.0;
    double any = 0.0;
    std::string bytes;
};

void fields(JsonArchive& json, Result& result) {
    json.field("number", result.number).any_number("any", result.any).packed("bytes", result.bytes);
}

class StepsTest : public testing::Test {
  protected:
    /// Does the step with a run's own Steps, and says whether it was there.
    bool was_kept(const StepInput& input, const Result& result, const std::string& program = "1", bool anew = false) {
        const Steps steps(Cache(folder_.path() / "steps"), program, anew);
        found_ = steps.step("test", input, [&] { return result; });
        EXPECT_EQ(steps.kept() + steps.made(), 1);
        return steps.kept() == 1;
    }

    TestFolder folder_;
    Result found_;
};

TEST_F(StepsTest, AreDoneAgainWhereWhatTheyFollowFromChanged) {
    const fs::path file = folder_.path() / "file";
    write_file(file, "a");
    const StepInput input{.settings = {{"a", 1.0}}, .files = {file}};
    EXPECT_FALSE(was_kept(input, {.number = 0.1}));
    EXPECT_TRUE(was_kept(input, {.number = 7.0}));
    EXPECT_EQ(found_.number, 0.1);
    EXPECT_FALSE(was_kept({.settings = {{"a", std::nextafter(1.0, 2.0)}}, .files = {file}}, {}));
    EXPECT_FALSE(was_kept({.settings = {{"a", 1.0}}}, {}));
    EXPECT_FALSE(was_kept(input, {}, "2")) << "another program";
    EXPECT_FALSE(was_kept(input, {.number = 0.2}, "1", true)) << "anew";
    EXPECT_TRUE(was_kept(input, {}));
    EXPECT_EQ(found_.number, 0.2) << "what was found anew is kept";
    write_file(file, "b");
    EXPECT_FALSE(was_kept(input, {}));
    fs::remove(file);
    EXPECT_FALSE(was_kept(input, {}));
}

TEST_F(StepsTest, BringBackEveryBit) {
    const std::string bytes("\0\xff\n\"", 4);
    int number = 0;
    for (const double any : {0.1, -0.0, HUGE_VAL, -HUGE_VAL, std::nan("")}) {
        for (const bool again : {false, true}) {
            EXPECT_EQ(was_kept({.settings = number}, {.number = 1.0 / 3.0, .any = any, .bytes = bytes}), again);
            EXPECT_EQ(found_.number, 1.0 / 3.0);
            EXPECT_TRUE(found_.any == any || (std::isnan(any) && std::isnan(found_.any)));
            EXPECT_EQ(std::signbit(found_.any), std::signbit(any));
            EXPECT_EQ(found_.bytes, bytes);
        }
        ++number;
    }
    formats::Image image = formats::make_image(2, 1, {"R"});
    image.pixels = {1e-45F, -0.0F};
    const Steps steps(Cache(folder_.path() / "steps"), "1", false);
    for (int i = 0; i < 2; ++i) {
        const formats::Image same = steps.step("picture", {}, [&] { return image; });
        EXPECT_EQ(same.pixels, image.pixels);
        EXPECT_EQ(same.channels, image.channels);
    }
    EXPECT_EQ(steps.kept(), 1);
}

// What fails, or has a number that its type does not expect, is tried again.
TEST_F(StepsTest, KeepNothingThatIsNoResult) {
    const Steps steps(Cache(folder_.path() / "steps"), "1", false);
    const auto failing = []() -> Result { throw std::runtime_error("fails"); };
    EXPECT_THROW(steps.step("test", {}, failing), std::runtime_error);
    for (int i = 0; i < 2; ++i) {
        EXPECT_TRUE(std::isnan(steps.step("test", {}, [] { return Result{.number = std::nan("")}; }).number));
    }
    EXPECT_EQ(steps.kept(), 0);
    const Steps none;
    EXPECT_EQ(none.step("test", {}, [] { return Result{.number = 2.0}; }).number, 2.0);
}

// What a table states is its values, not their order or notation.
TEST(StatedTable, IsWhatTheFileSays) {
    const auto stated = [](const std::string& text) { return TomlTable::parse(text, "t").stated(); };
    EXPECT_EQ(stated("a = 1.0 # one\nb = 'x'"), stated("b = \"x\"\na = 1e0"));
    EXPECT_NE(stated("a = 0.1"), stated("a = 0.10000000000000002"));
    EXPECT_NE(stated("a = inf"), stated("a = -inf"));
    EXPECT_NE(stated("a = inf"), stated("a = nan"));
    EXPECT_NE(stated("a = [[1, 2]]"), stated("a = [[1], [2]]"));
    EXPECT_NE(stated("a = [1]"), stated("b = [1]"));
    EXPECT_NE(stated("[a]\nb = true"), stated("[a]\nb = false"));
}

}  // namespace lensproof::findings::steps_test
