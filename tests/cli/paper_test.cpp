// tests/cli/paper_test.cpp — the figures of the paper of 2011: all of them are read, and a part of them is made.
#include <gtest/gtest.h>

#include "engine/base/data_root.h"
#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::paper_test {

TEST(Paper, ItsFiguresAreMadeAndHold) {
    const Workplace place;
    const std::string file = (data_root() / "experiments/paper.toml").string();
    const Outcome listed = place.run({"run", file, "--list"});
    EXPECT_EQ(listed.status, 0) << listed.err;
    for (const char* figure : {"muller-fisheye-f8", "fisheyes", "crosses", "discs", "bokeh", "vignetting", "depth",
                               "coatings", "streaks", "barrel", "night-street"}) {
        EXPECT_TRUE(says(listed.out, std::string("\n") + figure + " [[")) << figure;
    }
    const Outcome made = place.run({"run", file, "-o", "out", "--quality", "draft", "--only", "muller-fisheye-f8",
                                    "fisheye-distortion", "petzval-lines", "vignetting", "crosses"});
    EXPECT_EQ(made.status, 0) << made.out << made.err;
    EXPECT_TRUE(says(made.out, "PASS: out/report.html"));
    EXPECT_TRUE(place.has("out/images/crosses/imaged.png"));
    EXPECT_TRUE(says(place.content("out/report.html"), "A draft: pictures of scenes have 1/2 of the width and height"));
}

}  // namespace lensproof::paper_test
