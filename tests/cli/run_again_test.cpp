// tests/cli/run_again_test.cpp — runs that were ended go on where they were, to the same bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <thread>

#include "engine/base/data_root.h"
#include "tests/cli/program.h"
#include "tests/complaint.h"

namespace lensproof::run_again_test {

namespace fs = std::filesystem;

class RunAgain : public ::testing::Test {
  protected:
    RunAgain() { fill(place_); }

    static void SetUpTestSuite() {
        const Workplace place;
        fill(place);
        EXPECT_EQ(place.run({"run", "e.toml", "-o", "out"}).err, "");
        whole() = results(place, "out");
        EXPECT_GT(whole().size(), 5U);
    }

    static void fill(const Workplace& place) {
        fs::copy_file(data_root() / "lenses" / "tessar.toml", place.path() / "lens.toml");
        place.file("e.toml", experiment());
    }

    /// Three rendered views, measured, tested and traced.
    static std::string experiment() { return with(small_experiment(), "lens = \"tessar\"", "lens = \"lens.toml\""); }

    /// What the run finds that nothing ends.
    static std::map<std::string, std::string>& whole() {
        static std::map<std::string, std::string> files;
        return files;
    }

    /// The results that lie in `folder`, by their names there.
    static std::map<std::string, std::string> results(const Workplace& place, const std::string& folder) {
        std::map<std::string, std::string> files;
        for (const std::string& name : place.names()) {
            if (name.starts_with(folder + "/") && !name.starts_with(folder + "/steps") &&
                fs::is_regular_file(place.path() / name)) {
                files[name.substr(folder.size())] = place.content(name);
            }
        }
        return files;
    }

    /// The files of steps that lie in `folder`.
    [[nodiscard]] std::vector<std::string> steps(const std::string& folder) const {
        std::vector<std::string> names = place_.names();
        std::erase_if(names, [&](const std::string& name) {
            return !name.starts_with(folder + "/steps/") || name.find(".part") != std::string::npos;
        });
        return names;
    }

    /// Runs the experiment into `folder`, and expects that so many of its steps were there.
    void expect_kept(const std::string& folder, std::size_t kept, std::size_t all) const {
        const Outcome outcome = place_.run({"run", "e.toml", "-o", folder});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        const std::string words = kept == 0 ? ""
                                            : "lensproof: " + std::to_string(kept) + " of " + std::to_string(all) +
                                                  " steps were finished before, and kept in " + folder +
                                                  "/steps (--fresh: do all again)\n";
        EXPECT_EQ(outcome.err, words);
        for (const std::string& name : place_.names()) {
            EXPECT_EQ(name.find(".part"), std::string::npos) << "nothing is left half-written";
        }
    }

    /// Starts the run and waits until `count` steps are finished, or it has ended.
    [[nodiscard]] std::unique_ptr<RunningProgram> running(const std::string& folder, std::size_t count) const {
        auto run =
            std::make_unique<RunningProgram>(std::vector<std::string>{"run", "e.toml", "-o", folder}, place_.path());
        while (steps(folder).size() < count && !run->has_ended()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return run;
    }

    static constexpr std::size_t kSteps = 6;
    Workplace place_;
};

// Whenever it ends, what is finished stays finished.
TEST_F(RunAgain, GoesOnAfterKill9) {
    for (const std::size_t finished : {std::size_t{0}, std::size_t{2}, std::size_t{4}}) {
        const auto run = running("ended", finished);
        run->send(SIGKILL);
        run->wait();
        const std::size_t kept = steps("ended").size();
        EXPECT_GE(kept, finished);
        expect_kept("ended", kept, kSteps);
        EXPECT_EQ(results(place_, "ended"), whole());
        fs::remove_all(place_.path() / "ended");
    }
}

TEST_F(RunAgain, EndsOnASignalWithWhatIsFinished) {
    const auto run = running("ended", 1);
    run->send(SIGTERM);
    EXPECT_EQ(run->wait(), 3);
    EXPECT_TRUE(results(place_, "ended").empty());
    const std::size_t kept = steps("ended").size();
    EXPECT_LT(kept, kSteps);
    expect_kept("ended", kept, kSteps);
    EXPECT_EQ(results(place_, "ended"), whole());
}

TEST_F(RunAgain, DoesAgainWhatChanged) {
    expect_kept("out", 0, kSteps);
    expect_kept("out", kSteps, kSteps);
    // A limit is no part of any step.
    place_.file("e.toml", with(experiment(), "[simulations.chart]",
                               "[simulations.limits]\ndistortion_rms_px = 100.0\n[simulations.chart]"));
    expect_kept("out", kSteps, kSteps);
    // Another last view: its picture, the measurement and its self-test.
    place_.file("e.toml", with(experiment(), "[0.0, 30.0, 0.0]", "[0.0, 29.0, 0.0]"));
    expect_kept("out", kSteps - 3, kSteps);
    place_.file("lens.toml", place_.content("lens.toml") + "\n");
    expect_kept("out", 0, kSteps);
    EXPECT_EQ(place_.run({"run", "e.toml", "-o", "out", "--seed", "1"}).err, "");
    EXPECT_EQ(steps("out").size(), kSteps + 3 + kSteps + kSteps);
}

TEST_F(RunAgain, DoesAgainWhatIsDamagedAndAllWhereAsked) {
    expect_kept("out", 0, kSteps);
    const std::vector<std::string> files = steps("out");
    const std::string first = place_.content(files[0]);
    std::string flipped = first;
    flipped[flipped.size() / 2] ^= 1;
    place_.file(files[0], flipped);
    place_.file(files[1], place_.content(files[1]).substr(0, 100));
    place_.file(files[2], "");
    place_.file(files[3], place_.content(files[4]));
    expect_kept("out", kSteps - 4, kSteps);
    EXPECT_EQ(results(place_, "out"), whole());
    EXPECT_EQ(place_.content(files[0]), first);
    place_.file("out/report.json", "");
    const Outcome fresh = place_.run({"run", "e.toml", "-o", "out", "--fresh"});
    EXPECT_EQ(fresh.err, "");
    EXPECT_EQ(results(place_, "out"), whole());
}

TEST_F(RunAgain, TwoAtOnceDoNoHarm) {
    RunningProgram one({"run", "e.toml", "-o", "out"}, place_.path());
    RunningProgram other({"run", "e.toml", "-o", "out"}, place_.path());
    EXPECT_EQ(one.wait(), 0);
    EXPECT_EQ(other.wait(), 0);
    EXPECT_EQ(results(place_, "out"), whole());
    EXPECT_EQ(steps("out").size(), kSteps);
}

}  // namespace lensproof::run_again_test
