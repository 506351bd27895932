// tests/cli/check_test.cpp — `lensproof check` as a user meets it: statuses, JSON, claims, the drawing.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::check_test {

using Json = nlohmann::json;

constexpr const char* kSinglet =
    "name = \"singlet\"\nsource = \"none\"\nsurfaces = [\n"
    "  { radius_mm =  50, thickness_mm = 6, n_d = 1.5, V_d = 60, semi_diameter_mm = 10 },\n"
    "  { radius_mm = -50, thickness_mm = 2,                      semi_diameter_mm = 10 },\n"
    "  { stop = true,     thickness_mm = 46.9388,                semi_diameter_mm =  5 },\n]\n";

TEST(Check, AGoodLensIsOkAndItsJsonHasEveryKey) {
    const Workplace place;
    const Json lenses = place.json({"check", "tessar", "petzval"})["lenses"];
    ASSERT_EQ(lenses.size(), 2U);
    EXPECT_EQ(lenses[0]["lens"], "tessar");
    EXPECT_TRUE(lenses[0]["ok"].get<bool>());
    EXPECT_NEAR(lenses[0]["computed"]["bfl_mm"].get<double>(), 79.8307, 1e-3);
    EXPECT_NEAR(lenses[0]["computed"]["f_number"].get<double>(), 2.73, 5e-3);
    ASSERT_FALSE(lenses[0]["findings"].empty());
    for (const Json& finding : lenses[0]["findings"]) {
        for (const char* key : {"code", "severity", "surface", "message", "value", "limit", "unit"}) {
            EXPECT_TRUE(finding.contains(key)) << key;
        }
        EXPECT_NE(finding["severity"], "error");
    }
}

TEST(Check, AnErrorIsStatusOneAndAnUnreadableFileStatusTwo) {
    const Workplace place;
    place.file("crossed.toml", with(kSinglet, "thickness_mm = 6", "thickness_mm = 0.5"));
    place.file("missing-stop.toml", with(kSinglet, "stop = true,", ""));
    place.file("nan.toml", with(kSinglet, "radius_mm =  50", "radius_mm = nan"));
    place.file("no-table.toml", "name = \"x\"\nsource = \"y\"\n");
    for (const char* file : {"crossed.toml", "missing-stop.toml", "nan.toml"}) {
        SCOPED_TRACE(file);
        const Outcome outcome = place.run({"check", file});
        EXPECT_EQ(outcome.status, 1);
        EXPECT_TRUE(says(outcome.out, "error"));
        EXPECT_EQ(outcome.err, "");
    }
    // Nothing is said about the good one before the bad one ends the command.
    expect_refused(place, {"check", "tessar", "no-table.toml"}, {"no-table.toml"});
}

TEST(Check, WhatIsStatedIsHeldAgainstTheTable) {
    const Workplace place;
    // The lensmaker's equation: f = 51.0204 mm.
    place.file("singlet.toml", kSinglet);
    EXPECT_EQ(place.run({"check", "singlet.toml", "--stated", "efl_mm=51.02"}).status, 0);
    const Outcome off = place.run({"check", "singlet.toml", "--stated", "efl_mm=15.02"});
    EXPECT_EQ(off.status, 1);
    EXPECT_TRUE(says(off.out, "focal-length"));
    for (const char* unusable : {"efl=51", "efl_mm", "efl_mm=long", "f_number=-2", "efl_mm=nan"}) {
        SCOPED_TRACE(unusable);
        expect_refused(place, {"check", "singlet.toml", "--stated", unusable}, {"expected"});
    }
}

TEST(Check, DrawsALensThatCannotBeTracedToo) {
    const Workplace place;
    place.file("crossed.toml", with(kSinglet, "thickness_mm = 6", "thickness_mm = 0.5"));
    place.file("nan.toml", with(kSinglet, "radius_mm =  50", "radius_mm = nan"));
    for (const char* file : {"crossed.toml", "nan.toml"}) {
        EXPECT_EQ(place.run({"check", file, "--plot", "out.svg"}).status, 1);
        EXPECT_TRUE(says(place.content("out.svg"), "<svg"));
    }
    EXPECT_EQ(place.run({"check", "tessar", "petzval", "--plot", "out.svg"}).status, 2);
}

TEST(Check, TakesIndicesThatTraceTakes) {
    const Workplace place;
    place.file("rays.csv", "id,x_mm,y_mm,z_mm,dx,dy,dz,wavelength_nm\n1,0,1,-10,0,0,1,587.56\n");
    for (const char* unusable : {"LAK9=-3", "LAK9=0.5", "LAK9=11", "LAK9=nan", "LAK9", "=1.5"}) {
        SCOPED_TRACE(unusable);
        const Outcome check = place.run({"check", "tessar", "--index", unusable});
        const Outcome trace = place.run({"trace", "tessar", "--rays", "rays.csv", "--index", unusable});
        EXPECT_EQ(check.status, 2);
        EXPECT_EQ(check.err, trace.err);
        EXPECT_TRUE(says(check.err, "expected"));
    }
}

TEST(Check, DrawsAZoomPositionWithWhatWasFoundThere) {
    const Workplace place;
    place.file("zoom.toml", std::string(kSinglet) +
                                "[[zoom]]\nname = \"wide\"\ngaps_mm = { 1 = 6.0 }\n"
                                "[[zoom]]\nname = \"long\"\ngaps_mm = { 1 = 0.5 }\n");
    EXPECT_EQ(place.run({"check", "zoom.toml", "--plot", "first.svg"}).status, 1) << "for the second position";
    EXPECT_TRUE(says(place.content("first.svg"), "<svg"));
    EXPECT_FALSE(says(place.content("first.svg"), "surfaces-cross"));
    EXPECT_EQ(place.run({"check", "zoom.toml", "--zoom", "2", "--plot", "second.svg"}).status, 1);
    EXPECT_TRUE(says(place.content("second.svg"), "surfaces-cross"));
}

TEST(Check, AZoomIsCheckedAtOnePositionOrAtAll) {
    const Workplace place;
    const Json all = Json::parse(place.run({"check", "canon-zoom-70-200", "--json", "-"}).out)["lenses"][0];
    EXPECT_EQ(all["zoom"].size(), 3U);
    const Json last = Json::parse(place.run({"check", "canon-zoom-70-200", "--zoom", "3", "--json", "-"}).out);
    EXPECT_EQ(last["lenses"][0]["computed"], all["zoom"][2]);
    EXPECT_EQ(place.run({"check", "canon-zoom-70-200", "--zoom", "9"}).status, 2);
}

TEST(Check, SpeaksOfManufactureWhenAskedTo) {
    const Workplace place;
    const auto infos = [](const Json& report, const char* code) {
        return std::ranges::count_if(report["lenses"][0]["findings"], [&](const Json& finding) {
            return finding["code"] == code && finding["severity"] == "info";
        });
    };
    const Json report = Json::parse(place.run({"check", "biotar", "--json", "-"}).out);
    const Json customs = Json::parse(place.run({"check", "biotar", "--manufacture", "--json", "-"}).out);
    EXPECT_EQ(infos(report, "steep-surface"), 0);
    EXPECT_GT(infos(customs, "steep-surface"), 0);
    EXPECT_EQ(report["lenses"][0]["computed"], customs["lenses"][0]["computed"]);
}

// Sixteen surfaces, three of them coated, no semi-diameters: what the reader says stands before what the table is, and
// what surfaces share is said once.
TEST(Check, SaysInSectionsAndOnceWhatSurfacesShare) {
    const Workplace place;
    std::string rows;
    for (int i = 1; i <= 16; ++i) {
        rows += "SURF " + std::to_string(i) + "\n" + (i == 1 ? "  STOP\n" : "") + "  CURV 0.001\n  DISZ 3\n" +
                (i % 2 == 1 ? "  GLAS N-BK7\n" : "") + (i == 1 || i == 2 || i == 5 ? "  COAT AR\n" : "");
    }
    place.file("sixteen.zmx", "VERS 140124\nMODE SEQ\nUNIT MM X W X CM MR CPMM\nENPD 10\nSURF 0\n  DISZ INFINITY\n" +
                                  rows + "SURF 17\n  DISZ 0\n");
    const std::string text = place.run({"check", "sixteen.zmx", "--manufacture"}).out;
    const auto lines_with = [&](const std::string& word) {
        std::istringstream lines(text);
        std::vector<std::string> found;
        for (std::string line; std::getline(lines, line);) {
            if (says(line, word)) {
                found.push_back(line);
            }
        }
        return found;
    };
    ASSERT_EQ(lines_with("coating: ").size(), 1U) << text;
    EXPECT_TRUE(says(lines_with("coating: ")[0], "3 surfaces")) << text;
    EXPECT_TRUE(says(lines_with("coating: ")[0], "(surfaces 1, 2, 5)")) << text;
    ASSERT_EQ(lines_with("semi-diameter-missing: ").size(), 1U) << text;
    EXPECT_TRUE(says(lines_with("semi-diameter-missing: ")[0], "(surfaces 1–16)")) << text;
    const auto at = [&](const char* words) { return text.find(words); };
    EXPECT_LT(at("\nthe file as read:\n"), at("coating: "));
    EXPECT_LT(at("coating: "), at("\nthe lens:\n"));
    EXPECT_LT(at("\nthe lens:\n"), at("semi-diameter-missing: "));
    EXPECT_LT(at("semi-diameter-missing: "), at("\nadvice for manufacture:\n"));
    EXPECT_LT(at("\nadvice for manufacture:\n"), at("nearly-flat: "));

    // The JSON has them all.
    const Json report =
        Json::parse(place.run({"check", "sixteen.zmx", "--manufacture", "--json", "-"}).out)["lenses"][0];
    std::map<std::pair<std::string, std::string>, int> count;
    for (const Json& finding : report["findings"]) {
        ++count[{finding["section"].get<std::string>(), finding["code"].get<std::string>()}];
    }
    EXPECT_EQ((count[{"file", "coating"}]), 3);
    EXPECT_EQ((count[{"lens", "semi-diameter-missing"}]), 16);
    EXPECT_GT((count[{"manufacture", "nearly-flat"}]), 0);
    EXPECT_EQ((count[{"lens", "nearly-flat"}]), 0);
}

// A section without findings has no heading.
TEST(Check, SaysNothingOfEmptySections) {
    const Workplace place;
    const std::string text = place.run({"check", "tessar"}).out;
    EXPECT_FALSE(says(text, "as read")) << text;
    EXPECT_TRUE(says(text, "the lens:")) << text;
    EXPECT_FALSE(says(text, "manufacture")) << text;
}

}  // namespace lensproof::check_test
