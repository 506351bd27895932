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
              "a.toml:1: semi_diam_mm: is not a key that is known here; did you mean \"semi_diameter_mm\"?");
    EXPECT_EQ(
        complaint_about_keys("wombat = 3.0\n"),
        "a.toml:1: wombat: is not a key that is known here; known are: radius_mm, semi_diameter_mm, thickness_mm");
}

}  // namespace lensproof::toml_test
