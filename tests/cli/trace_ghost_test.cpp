// tests/cli/trace_ghost_test.cpp — `lensproof trace --sequence` as a user meets it.
#include <gtest/gtest.h>

#include "tests/cli/program.h"
#include "tests/cli/trace_table.h"
#include "tests/complaint.h"

namespace lensproof::trace_ghost_test {

std::vector<std::string> along(const std::string& sequence, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"trace", "tessar", "--rays", "rays.csv", "--sequence", sequence};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

std::vector<std::string> surfaces_met(const Outcome& outcome) {
    std::vector<std::string> met;
    for (const std::vector<std::string>& row : cells_of(outcome.out)) {
        met.push_back(row.at(1));
    }
    return {met.begin() + 1, met.end()};
}

TEST(TraceGhost, WritesARowForEachSurfaceInTheOrderMet) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + kAxialRay);
    using Names = std::vector<std::string>;
    EXPECT_EQ(surfaces_met(place.run(along("2,1"))),
              (Names{"1", "2", "1", "2", "3", "4", "5", "6", "7", "8", "image"}));
    EXPECT_EQ(surfaces_met(place.run(along("3,2,3,1"))),
              (Names{"1", "2", "3", "2", "3", "2", "1", "2", "3", "4", "5", "6", "7", "8", "image"}));
    EXPECT_EQ(surfaces_met(place.run(along("image,8", {"--sensor-reflectance", "0.1"}))),
              (Names{"1", "2", "3", "4", "5", "6", "7", "8", "image", "8", "image"}));
    for (const char* precision : {"float", "extended"}) {
        EXPECT_EQ(surfaces_met(place.run(along("2,1", {"--precision", precision}))).size(), 11U) << precision;
    }
}

TEST(TraceGhost, RefusesSequencesThatLightDoesNotTake) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + kAxialRay);
    for (const auto& [sequence, words] : {std::pair{"1,2", std::vector<std::string>{"1,2", "surface 2", "in front of"}},
                                          {"2", {"odd"}},
                                          {"2,1,3", {"odd"}},
                                          {"3,3", {"surface 3"}},
                                          {"3,2,1,0", {"\"0\" is no surface", "1 to 8"}},
                                          {"9,1", {"\"9\" is no surface", "image"}},
                                          {"two,1", {"\"two\""}},
                                          {"1.5,1", {"\"1.5\""}},
                                          {"", {"--sequence"}},
                                          {"4,2,1,1", {"surface 1 cannot follow surface 2", "behind"}},
                                          {"image,1", {"sensor", "--sensor-reflectance"}}}) {
        expect_refused(place, along(sequence), words);
    }
    expect_refused(place, along("2,1", {"--reverse"}), {"--reverse", "--sequence"});
    expect_refused(place, along("image,1", {"--sensor-reflectance", "1.5"}), {"--sensor-reflectance"});
    const std::string stop = "3";
    place.file("singlet.toml", kSinglet);
    expect_refused(place, {"trace", "singlet.toml", "--rays", "rays.csv", "--sequence", stop + ",2"},
                   {"surface 3 is the stop", "--blade-reflectance"});
}

}  // namespace lensproof::trace_ghost_test
