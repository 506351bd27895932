// tests/cli/twins_command_test.cpp — `lensproof twins PHOTOS… --chart CHART --lens LENS`.
#include <gtest/gtest.h>

#include "engine/base/file.h"
#include "engine/base/write_file.h"
#include "tests/cli/program.h"
#include "tests/complaint.h"
#include "tests/tessar_photos.h"

namespace lensproof::twins_command_test {

namespace {

/// Takes five photos of a chart through a Tessar, into out/images/camera.
void take_photos(const Workplace& place) {
    write_file(place.path() / "camera.toml", tessar_photos(320, 32));
    write_file(place.path() / "chart.toml", std::string("[chart]\n") + kTessarChart);
    // What a camera's steps are is known before they are done.
    EXPECT_TRUE(says(place.run({"run", "camera.toml", "-o", "out", "--list"}).out,
                     "  camera, view 5 of 5\n  camera, measuring\n  camera, self-test\n  camera, tracing\n"));
    EXPECT_EQ(place.run({"run", "camera.toml", "-o", "out"}).status, 0);
    EXPECT_TRUE(says(place.run({"run", "camera.toml", "-o", "out", "--dry-run"}).out, "8 of 8 steps are kept"));
}

// The lens agrees with photos through itself, and what was written is an experiment that gives the same again.
TEST(TwinsCommand, WritesAnExperimentAndRunsIt) {
    const Workplace place;
    take_photos(place);
    const std::vector<std::string> command = {
        "twins", "out/images/camera", "--chart", "chart.toml", "--lens", "tessar", "--f-number",
        "11",    "--limit",           "0.1",     "--response", "camera", "-o",     "twins"};
    const Outcome outcome = place.run(command);
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_TRUE(says(outcome.out, "PASS: twins/report.html"));
    EXPECT_TRUE(says(read_file(place.path() / "twins/photos.toml"), "\"../out/images/camera/view-1.png\""));
    const std::string report = read_file(place.path() / "twins/report.json");
    EXPECT_EQ(place.run({"run", "twins/twins.toml", "-o", "twins"}).status, 0);
    EXPECT_EQ(read_file(place.path() / "twins/report.json"), report);
}

TEST(TwinsCommand, RefusesWhatIsNotThere) {
    const Workplace place;
    write_file(place.path() / "chart.toml", std::string("[chart]\n") + kTessarChart);
    std::filesystem::create_directory(place.path() / "empty");
    expect_refused(place, {"twins", "empty", "--chart", "chart.toml", "--lens", "tessar"}, {"empty"});
    expect_refused(place, {"twins", "none.jpg", "--chart", "chart.toml", "--lens", "tessar"}, {"none.jpg"});
    expect_refused(place, {"twins", "empty", "--lens", "tessar"}, {"--chart"});
    expect_refused(place, {"twins", "chart.toml", "--chart", "chart.toml", "--lens", "tesar", "-o", "out"},
                   {"tesar", "tessar"});
}

}  // namespace

}  // namespace lensproof::twins_command_test
