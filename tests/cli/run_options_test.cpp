// tests/cli/run_options_test.cpp — what `lensproof run` can be asked besides: plans, parts, earlier reports, other
// forms.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::run_options_test {

using nlohmann::json;

/// Two sweeps, of six and of four values, and a third where it is asked for.
std::string two_sweeps(const std::string& limit, const std::string& third = "") {
    return "title = \"Two <sweeps>\"\n"
           "[[sweeps]]\nname = \"spots\"\nlens = \"tessar\"\nf_number = [4.0, 5.6, 8.0]\nfield_deg = [0.0, 10.0]\n"
           "measure = [\"spot_rms_um\"]\n[[sweeps.checks]]\nmeasure = \"spot_rms_um\"\nat_most = " +
           limit +
           "\n[[sweeps]]\nname = \"lengths\"\nlens = [\"tessar\", \"petzval\"]\nf_number = [4.0, 8.0]\n"
           "measure = [\"efl_mm\"]\n[[sweeps.checks]]\nmeasure = \"efl_mm\"\nbetween = [95.0, 105.0]\n" +
           third;
}

class RunOptionsTest : public ::testing::Test {
  protected:
    RunOptionsTest() { place_.file("e.toml", two_sweeps("1000.0")); }

    [[nodiscard]] json report(const std::string& folder) const {
        return json::parse(place_.content(folder + "/report.json"));
    }

    Workplace place_;
};

TEST_F(RunOptionsTest, ListsAndPlansWithoutDoing) {
    const Outcome listed = place_.run({"run", "e.toml", "-o", "out", "--list"});
    EXPECT_EQ(listed.status, 0) << listed.err;
    EXPECT_TRUE(says(listed.out, "spots [[sweeps]]\n  tessar, f/4, 0°\n"));
    EXPECT_FALSE(place_.has("out"));
    EXPECT_TRUE(says(place_.run({"run", "e.toml", "-o", "out", "--dry-run"}).out, "0 of 10 steps are kept"));
    EXPECT_FALSE(place_.has("out"));
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "out", "--only", "spots"}).status, 0);
    const json plan = json::parse(place_.run({"run", "e.toml", "-o", "out", "--dry-run", "--json", "-"}).out);
    EXPECT_EQ(plan["kept"], 6);
    EXPECT_EQ(plan["steps"], 10);
    EXPECT_GT(plan["seconds"], 0.0);
    EXPECT_EQ(plan["studies"][1]["name"], "lengths");
    EXPECT_EQ(plan["studies"][1]["steps"][0]["kept"], false);
}

TEST_F(RunOptionsTest, DoesAPartAlone) {
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "out", "--only", "lengths"}).status, 0);
    EXPECT_EQ(report("out")["swept"].size(), 1U);
    EXPECT_TRUE(says(report("out")["reproduce"].get<std::string>(), "--only lengths"));
    const Outcome wrong = place_.run({"run", "e.toml", "-o", "out", "--only", "length"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_TRUE(says(wrong.err, "expected a study of e.toml: lengths, spots"));
}

// Shards of the steps that one machine or several do in any order; the run that writes the report finds all of them
// kept, and says what it says without.
TEST_F(RunOptionsTest, DoesShardsOfTheSteps) {
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "whole"}).status, 0);
    std::size_t made = 0;
    for (const char* shard : {"3/3", "1/3", "2/3"}) {
        const Outcome part = place_.run({"run", "e.toml", "-o", "shared", "--shard", shard, "--json", "-"});
        EXPECT_EQ(part.status, 0) << part.err;
        made += json::parse(part.out)["made"].get<std::size_t>();
    }
    EXPECT_EQ(made, 10U);
    EXPECT_FALSE(place_.has("shared/report.json"));
    const Outcome rest = place_.run({"run", "e.toml", "-o", "shared"});
    EXPECT_TRUE(says(rest.err, "10 of 10 steps were finished before")) << rest.err;
    EXPECT_EQ(place_.content("shared/report.json"), place_.content("whole/report.json"));
    EXPECT_EQ(place_.content("shared/report.html"), place_.content("whole/report.html"));

    const Outcome wrong = place_.run({"run", "e.toml", "-o", "other", "--shard", "4/3"});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_TRUE(says(wrong.err, "--shard is \"4/3\", expected i/n"));
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "other", "--shard", "1/3", "--junit", "x.xml"}).status, 2);
    EXPECT_FALSE(place_.has("other"));
}

// No lens opens to f/0.5: that sweep has no value, the others have theirs, and the status says of what kind the fault
// is.
TEST_F(RunOptionsTest, AFailedStudyStandsInTheReport) {
    const std::string hopeless =
        "[[sweeps]]\nname = \"hopeless\"\nlens = \"tessar\"\nf_number = [0.5, 0.6]\nmeasure = [\"efl_mm\"]\n";
    place_.file("e.toml", two_sweeps("1000.0", hopeless));
    const Outcome outcome = place_.run({"run", "e.toml", "-o", "out", "--junit", "junit.xml"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_TRUE(says(outcome.err, "lensproof: hopeless: sweep \"hopeless\": "));
    EXPECT_EQ(report("out")["swept"].size(), 2U);
    EXPECT_EQ(report("out")["verdict"], "INCONCLUSIVE");
    EXPECT_EQ(report("out")["failures"][0]["study"], "hopeless");
    EXPECT_TRUE(says(place_.content("out/report.html"), "Studies that came to no end"));
    const std::string junit = place_.content("junit.xml");
    EXPECT_TRUE(says(junit, "<testsuite name=\"Two &lt;sweeps&gt;\" tests=\"3\" failures=\"0\" errors=\"1\">"));
    EXPECT_TRUE(says(junit, "name=\"hopeless\">\n      <error type=\"input\""));
    place_.file("e.toml", two_sweeps("0.001", hopeless));
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "out"}).status, 2) << "graver than a check that fails";
    place_.file("e.toml", "title = \"t\"\n" + hopeless);
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "none"}).status, 2);
    EXPECT_FALSE(place_.has("none/report.json")) << "nothing was found";
}

TEST_F(RunOptionsTest, SaysWhatChangedSinceAnEarlierReport) {
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "out"}).status, 0);
    const Outcome same = place_.run({"run", "e.toml", "-o", "again", "--against", "out"});
    EXPECT_TRUE(says(same.out, "0 of 2 verdicts, 0 of ")) << same.err;
    place_.file("e.toml", two_sweeps("0.001"));
    const Outcome other = place_.run({"run", "e.toml", "-o", "out", "--against", "out/report.json"});
    EXPECT_EQ(other.status, 1);
    EXPECT_TRUE(says(other.err, "10 of 10 steps were finished before")) << "a threshold is no part of a step";
    EXPECT_TRUE(says(other.out, "PASS          → FAIL          spots-1"));
    const json against = report("out")["against"];
    EXPECT_EQ(against["verdicts"].size(), 1U);
    EXPECT_EQ(against["changed_numbers"], 1) << "the limit";
    EXPECT_EQ(against["numbers"][0]["number"], "checks[spots-1].limit");
    EXPECT_TRUE(against["pictures"].empty());
    std::string wider = two_sweeps("0.001");
    wider.replace(wider.find("10.0]"), 5, "12.0]");
    place_.file("e.toml", wider);
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "out", "--against", "again"}).status, 1);
    EXPECT_EQ(report("out")["against"]["pictures"][0]["change"], "changed");
    EXPECT_TRUE(says(place_.content("out/report.html"), "<h3>Against again/report.json</h3>"));
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "out", "--against", "e.toml"}).status, 2);
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "out", "--against", "nowhere"}).status, 2);
}

TEST_F(RunOptionsTest, LinksTheReportsOfTheUsualFolder) {
    EXPECT_EQ(place_.run({"run", "e.toml"}).status, 0);
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "output/other"}).status, 0);
    const std::string index = place_.content("output/index.html");
    EXPECT_TRUE(says(index, "<a href=\"e/report.html\">Two &lt;sweeps&gt;</a>"));
    EXPECT_TRUE(says(index, "<a href=\"other/report.html\">"));
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "own/out"}).status, 0);
    EXPECT_FALSE(place_.has("own/index.html"));
    place_.file("output/index.html", "mine");
    EXPECT_EQ(place_.run({"run", "e.toml"}).status, 0);
    EXPECT_EQ(place_.content("output/index.html"), "mine");
}

// Each value is kept as it is found: what is killed goes on, to the same bytes.
TEST_F(RunOptionsTest, ASweepGoesOnAfterKill9) {
    std::string slow = two_sweeps("1000.0");
    slow.replace(slow.find("[0.0, 10.0]"), 11, "{ from = 0.0, to = 15.0, count = 30 }");
    place_.file("e.toml", slow);
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "whole"}).status, 0);
    const auto kept = [&] {
        std::size_t count = 0;
        for (const std::string& name : place_.names()) {
            count += name.starts_with("ended/steps/") && name.find(".part") == std::string::npos ? 1 : 0;
        }
        return count;
    };
    RunningProgram run({"run", "e.toml", "-o", "ended"}, place_.path());
    while (kept() < 5 && !run.has_ended()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    run.send(SIGKILL);
    EXPECT_EQ(run.wait(), -SIGKILL);
    const std::size_t finished = kept();
    EXPECT_LT(finished, 94U);
    const Outcome rest = place_.run({"run", "e.toml", "-o", "ended"});
    EXPECT_TRUE(says(rest.err, "lensproof: " + std::to_string(finished) + " of 94 steps were finished before"));
    EXPECT_EQ(place_.content("ended/report.json"), place_.content("whole/report.json"));
    EXPECT_EQ(place_.content("ended/report.html"), place_.content("whole/report.html"));
}

}  // namespace lensproof::run_options_test
