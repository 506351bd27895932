// tests/cli/paper_test.cpp — the figures of the paper of 2011, as a draft: all are made, and what is held to a number
// holds.
#include <gtest/gtest.h>

#include "engine/base/data_root.h"
#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::paper_test {

TEST(Paper, ItsFiguresAreMadeAndHold) {
    const Workplace place;
    const Outcome made = place.run(
        {"run", (data_root() / "experiments/paper.toml").string(), "-o", "out", "--quality", "draft", "--json", "-"});
    EXPECT_EQ(made.status, 0) << made.out << made.err;
    const auto report = nlohmann::json::parse(made.out);
    EXPECT_EQ(report["verdict"], "PASS");
    EXPECT_EQ(report.count("failures"), 0U);
    for (const char* figure : {"muller-fisheye-f8", "fisheyes", "crosses", "discs", "bokeh", "vignetting", "depth",
                               "coatings", "streaks", "barrel", "night-street"}) {
        const bool is_there = std::ranges::any_of(report["subjects"], [&](const nlohmann::json& subject) {
            return subject["id"].get<std::string>().starts_with(figure);
        });
        EXPECT_TRUE(is_there) << figure;
    }
    EXPECT_TRUE(place.has("out/images/crosses/picture.jpg"));
    EXPECT_TRUE(says(place.content("out/report.html"), "A draft: pictures of scenes have 1/2 of the width and height"));
}

}  // namespace lensproof::paper_test
