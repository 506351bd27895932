// tests/experiments/findings/varied_test.cpp — one table that stands for many.
#include "experiments/findings/varied.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "tests/complaint.h"

namespace lensproof::findings::varied_test {

std::vector<Varied> varied(const std::string& text) {
    TomlTable top = TomlTable::parse(text, "experiment.toml");
    return varied_tables(top, "cameras");
}

std::string complaint(const std::string& text) {
    return complaint_about([&] { varied(text); });
}

TEST(Varied, ATableWithoutItIsItself) {
    std::vector<Varied> tables = varied("[[cameras]]\nname = \"a\"\n[[cameras]]\nname = \"b\"\n");
    ASSERT_EQ(tables.size(), 2U);
    EXPECT_EQ(tables[1].table.text("name"), "b");
    EXPECT_TRUE(tables[1].at.empty());
    EXPECT_EQ(words_of(tables[1].at), "");
}

TEST(Varied, MakesATableOfEachCombinationTheLastKeyFastest) {
    std::vector<Varied> tables = varied(
        "[[cameras]]\nname = \"tessar\"\ncamera = { lens = \"tessar\", f_number = 2.8, blades = 9 }\n"
        "vary.model = [\"pinhole\", \"thin lens\"]\n"
        "vary.camera.f_number = { from = 4.0, to = 8.0, step = 2.0 }\n"
        "vary.camera.blades = 7\n");
    ASSERT_EQ(tables.size(), 6U);
    std::vector<std::string> names;
    std::ranges::transform(tables, std::back_inserter(names), [](Varied& one) { return one.table.text("name"); });
    EXPECT_EQ(names, (std::vector<std::string>{"tessar-7-4-pinhole", "tessar-7-4-thin_lens", "tessar-7-6-pinhole",
                                               "tessar-7-6-thin_lens", "tessar-7-8-pinhole", "tessar-7-8-thin_lens"}));
    TomlTable& last = tables.back().table;
    TomlTable camera = last.table("camera");
    EXPECT_EQ(camera.text("lens"), "tessar");
    EXPECT_EQ(camera.number("f_number"), 8.0);
    EXPECT_EQ(camera.integer("blades", 1, 100), 7);
    camera.finish();
    EXPECT_EQ(last.text("model"), "thin lens");
    last.finish();
    EXPECT_EQ(words_of(tables.back().at), "blades 7, f/8, thin lens");
}

TEST(Varied, ATableThatHasNoNameNeedsNone) {
    std::vector<Varied> tables = varied("[[cameras]]\nvary.lens = [\"lenses/tessar.toml\", \"petzval\"]\n");
    ASSERT_EQ(tables.size(), 2U);
    EXPECT_EQ(tables[0].table.text("lens"), "lenses/tessar.toml");
    EXPECT_EQ(words_of(tables[0].at), "tessar");
    EXPECT_FALSE(tables[0].table.has("name"));
}

TEST(Varied, TextsKeepEveryLetter) {
    std::vector<Varied> tables = varied("[[cameras]]\nname = \"a\"\nvary.title = [\"a \\\"b\\\" \\\\ é\\n\"]\n");
    EXPECT_EQ(tables.at(0).table.text("title"), "a \"b\" \\ é\n");
}

TEST(Varied, ComplaintsOfAValueNameItsLine) {
    const std::string text =
        "title = \"x\"\n\n[[cameras]]\nname = \"a\"\ncamera.f_number = 2.0\nvary.camera.f_number = [4.0, -8.0]\n";
    EXPECT_TRUE(says(complaint(text), "experiment.toml:6: "));
    std::vector<Varied> tables = varied("[[cameras]]\nname = \"a\"\n\n\nvary.camera.blades = [5, 6.5]\n");
    EXPECT_TRUE(says(complaint_about([&] { tables.at(1).table.table("camera").integer("blades", 3, 99); }),
                     "experiment.toml:5: vary.camera.blades: is 6.5"));
}

TEST(Varied, RefusesWhatMakesNoTables) {
    const auto with = [](const std::string& vary) { return "[[cameras]]\nname = \"a\"\n" + vary + "\n"; };
    EXPECT_TRUE(says(complaint(with("vary.f_number = []")), ":3: "));
    EXPECT_TRUE(says(complaint(with("vary = {}")), "makes 0 tables, expected 1 to 1000"));
    EXPECT_TRUE(says(complaint(with("vary.f_number = [2.0, 2.0]")), "has f/2 twice"));
    EXPECT_TRUE(says(complaint(with("vary.name = [\"b\"]")), "follows from the others"));
    EXPECT_TRUE(says(complaint(with("vary.\"a b\" = [1.0]")), "expected a key of letters"));
    EXPECT_TRUE(says(complaint(with("vary.a = [[1.0, 2.0]]")), "expected some numbers"));
    EXPECT_TRUE(says(complaint(with("vary.a.b = { from = 0.0, to = 1.0, count = 1000 }\n"
                                    "vary.c = { from = 0.0, to = 1.0, count = 2 }")),
                     "makes 2000 tables"));
}

}  // namespace lensproof::findings::varied_test
