// tests/engine/base/toml_test.cpp — keys and brackets of TOML, however deep; keys that are misspelt.
#include "engine/base/toml.h"

#include <gtest/gtest.h>

#include "tests/complaint.h"

namespace lensproof::toml_test {

std::string repeated(const std::string& text, int count) {
    std::string all;
    for (int i = 0; i < count; ++i) {
        all += text;
    }
    return all;
}

std::string key_of(int parts) {
    return "a" + repeated(".a", parts - 1);
}

// Each part of a key is a table in the one before, each bracket a value in the one before: a library that calls itself
// for each would run out of stack at some ten thousand.
TEST(Toml, DepthIsBounded) {
    const auto complaint = [](const std::string& text) {
        return complaint_about([&] { TomlTable::parse(text, "deep.toml"); });
    };
    const std::string many = key_of(40'000);
    EXPECT_TRUE(says(complaint("x = 1\n" + many + " = 1"), "deep.toml:2: a key of more than 32 parts"));
    EXPECT_TRUE(says(complaint("[" + many + "]"), "deep.toml:1: a key of more than 32 parts"));
    EXPECT_TRUE(says(complaint("[[" + many + "]]"), "deep.toml:1: a key of more than 32 parts"));
    EXPECT_TRUE(says(complaint("x = {" + many + " = 1}"), "32 parts"));
    EXPECT_TRUE(says(complaint(repeated("\"a\" . 'b'.", 20'000) + "c = 1"), "32 parts"));
    EXPECT_TRUE(says(complaint("x = {y = \"\"\"\"q\"\"\"\", " + many + " = 1}"), "32 parts")) << "quotes before three";
    EXPECT_TRUE(says(complaint("x = " + repeated("[", 100'000) + repeated("]", 100'000)), "deep.toml:1: not TOML"));
    EXPECT_TRUE(says(complaint("x = " + repeated("{a=", 100'000)), "deep.toml:1: not TOML"));
}

// Keys of 32 parts are read, also inside one another as deep as brackets may be.
TEST(Toml, WhatIsAllowedFitsTheStack) {
    const std::string key = key_of(32);
    EXPECT_NO_THROW(TomlTable::parse(key + " = 1", "a.toml"));
    EXPECT_NO_THROW(
        TomlTable::parse(key + " = " + repeated("{" + key + " = ", 250) + "1" + repeated("}", 250), "a.toml"));
}

// Dots that separate no parts of a key.
TEST(Toml, DotsInTextsCommentsAndNumbersAreFree) {
    const std::string dots = repeated("a.", 1000);
    EXPECT_EQ(TomlTable::parse("x = \"\\\"" + dots + "\" # " + dots, "a.toml").text("x"), '"' + dots);
    EXPECT_EQ(TomlTable::parse("x = '" + dots + "\\'", "a.toml").text("x"), dots + '\\');
    EXPECT_EQ(TomlTable::parse("x = \"\"\"" + dots + "\n\"" + dots + "\"\"\"\ny = 1", "a.toml").text("x"),
              dots + "\n\"" + dots);
    EXPECT_EQ(TomlTable::parse("x = [" + repeated("1.5, ", 1000) + "]", "a.toml").numbers("x", 1000).size(), 1000U);
}

std::string complaint_about_keys(const std::string& text) {
    TomlTable table = TomlTable::parse(text, "a.toml");
    for (const char* key : {"radius_mm", "semi_diameter_mm", "thickness_mm"}) {
        table.optional_number(key);
    }
    return complaint_about([&] { table.finish(); });
}

TEST(Toml, AMisspeltKeyIsOfferedItsNeighbour) {
    EXPECT_EQ(complaint_about_keys("radius_mm = 1\n"), "");
    EXPECT_EQ(complaint_about_keys("semi_diam_mm = 3.0\n"),
              "a.toml:1: semi_diam_mm: is not a key that is known here; did you mean \"semi_diameter_mm\"? Known are: "
              "radius_mm, semi_diameter_mm, thickness_mm");
    EXPECT_EQ(
        complaint_about_keys("wombat = 3.0\n"),
        "a.toml:1: wombat: is not a key that is known here; known are: radius_mm, semi_diameter_mm, thickness_mm");
}

// Known is also what was only asked after, and what is missing may stand there misspelt.
TEST(Toml, KeysAskedAfterAreKnownAndMissingOnesMayBeMisspelt) {
    TomlTable asked = TomlTable::parse("semi_diam_mm = 3.0\n", "a.toml");
    EXPECT_FALSE(asked.has("semi_diameter_mm"));
    EXPECT_TRUE(says(complaint_about([&] { asked.finish(); }), "did you mean \"semi_diameter_mm\"?"));
    TomlTable not_taken = TomlTable::parse("radius_mm = 3.0\n", "a.toml");
    EXPECT_TRUE(not_taken.has("radius_mm"));
    EXPECT_EQ(complaint_about([&] { not_taken.finish(); }),
              "a.toml:1: radius_mm: is not a key that is known here; known are: ");
    TomlTable misspelt = TomlTable::parse("square_mm = 4\nshuter_s = 1\n", "a.toml");
    EXPECT_EQ(complaint_about([&] { misspelt.number("shutter_s"); }),
              "a.toml:1: shutter_s: is missing; is \"shuter_s\" meant to be it?");
    EXPECT_EQ(complaint_about([&] { misspelt.number("squares"); }), "a.toml:1: squares: is missing");
}

// A table over another: values, tables in tables, lists as a whole; and each complaint names the file that is to blame.
TEST(Toml, OneTableOverAnother) {
    const TomlTable under = TomlTable::parse("a = 1\nb = 2\n[t]\nx = 3\ny = 4\n[[l]]\nz = 5\n[[l]]\nz = 6\n", "u.toml");
    TomlTable over = TomlTable::parse("v.b = 7\nv.t.y = \"eight\"\n\nv.l = [{ z = 9 }]\n", "o.toml");
    TomlTable both = under.overlaid(over.table("v"));
    EXPECT_EQ(both.keys(), (std::vector<std::string>{"a", "b", "l", "t"}));
    EXPECT_EQ(both.number("a"), 1.0);
    EXPECT_EQ(both.number("b"), 7.0);
    TomlTable t = both.table("t");
    EXPECT_EQ(t.number("x"), 3.0);
    EXPECT_TRUE(says(complaint_about([&] { t.number("y"); }), "o.toml:2: v.t.y: is 'eight'"));
    EXPECT_TRUE(says(complaint_about([&] { t.number("x", {.min = 4.0}); }), "u.toml:4: t.x: is 3"));
    std::vector<TomlTable> list = both.tables("l");
    ASSERT_EQ(list.size(), 1U);
    EXPECT_EQ(list[0].number("z"), 9.0);
    EXPECT_EQ(list[0].where("z"), "o.toml:4: v.l[1].z");
    EXPECT_EQ(both.stated(),
              TomlTable::parse("a = 1\nb = 7\nt = { x = 3, y = \"eight\" }\nl = [{ z = 9 }]", "").stated());
    EXPECT_EQ(both.file(), "u.toml");
    EXPECT_NO_THROW(both.finish());
    TomlTable unknown = under.overlaid(TomlTable::parse("\n\nc = 1", "o.toml"));
    for (const char* key : {"a", "b", "t", "l"}) {
        EXPECT_TRUE(unknown.has(key));
    }
    EXPECT_TRUE(says(complaint_about([&] {
                         unknown.number("a"), unknown.number("b"), unknown.table("t"), unknown.tables("l"),
                             unknown.finish();
                     }),
                     "o.toml:3: c: is not a key"));
}

}  // namespace lensproof::toml_test
