// tests/cli/chart_command_test.cpp — `lensproof chart`: what it writes, and that the file beside it is for `measure`.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::chart_command_test {

using Json = nlohmann::json;

// A4 across is 297 × 210 mm: at 50 dpi 585 × 413 pixels (PNG, ISO 15948, 11.2.2: width and height at byte 16).
TEST(ChartCommand, WritesAPageAndItsDescription) {
    const Workplace place;
    const Json json = place.json(
        {"chart", "checkerboard", "--squares", "10x7", "--square-mm", "25", "--dpi", "50", "-o", "board.png"});
    EXPECT_EQ(json.at("file"), "board.png");
    EXPECT_EQ(json.at("description"), "board.toml");
    EXPECT_EQ(json.at("pattern_mm"), Json({250.0, 175.0}));
    EXPECT_EQ(json.at("paper_mm"), Json({297.0, 210.0}));
    EXPECT_EQ(place.names(), (std::vector<std::string>{"board.png", "board.toml"}));
    const std::string png = place.content("board.png");
    const auto number = [&](std::size_t at) {
        return static_cast<unsigned char>(png.at(at + 2)) * 256 + static_cast<unsigned char>(png.at(at + 3));
    };
    EXPECT_EQ(number(16), 585);
    EXPECT_EQ(number(20), 413);
    for (const char* part : {"[chart]", "kind = \"checkerboard\"", "squares = [10, 7]", "square_mm = 25"}) {
        EXPECT_TRUE(says(place.content("board.toml"), part));
    }
}

// The page is a picture of the chart, seen head-on: `measure` finds it by the file that was written beside it, and then
// says what one such view cannot tell.
TEST(ChartCommand, WhatItWritesIsFound) {
    const Workplace place;
    ASSERT_EQ(place.run({"chart", "disc-grid", "--dpi", "50", "-o", "discs.png", "--quiet"}).status, 0);
    expect_refused(place,
                   {"measure", "discs.png", "--chart", "discs.toml", "--model", "brown-conrady", "--no-self-test"},
                   {"1 view does not determine the focal length"});
}

TEST(ChartCommand, NamesTheFileByTheKindAndIsTheSameTwice) {
    const Workplace place;
    ASSERT_EQ(place.run({"chart", "charuco", "--paper", "A5"}).status, 0);
    const std::string first = place.content("charuco.pdf");
    EXPECT_EQ(first.substr(0, 5), "%PDF-");
    ASSERT_EQ(place.run({"chart", "charuco", "--paper", "A5"}).status, 0);
    EXPECT_EQ(place.content("charuco.pdf"), first);
}

TEST(ChartCommand, RefusesWhatCannotBePrinted) {
    const Workplace place;
    expect_refused(place, {"chart", "tartan"}, {"tartan", "checkerboard"});
    expect_refused(place, {"chart", "checkerboard", "--squares", "10x7", "--square-mm", "50"}, {"500", "297"});
    expect_refused(place, {"chart", "checkerboard", "-o", "board.jpg"}, {"board.jpg", ".pdf"});
    expect_refused(place, {"chart", "checkerboard", "--paper", "A9"}, {"A9", "A0"});
    expect_refused(place, {"chart", "checkerboard", "--dpi", "100000", "-o", "board.png"}, {"--dpi", "pixels"});
    expect_refused(place, {"chart", "checkerboard", "--squares", "ten"}, {"--squares", "ten"});
}

}  // namespace lensproof::chart_command_test
