// What bounds time and memory, whatever the input.
#include <gtest/gtest.h>

#include <chrono>

#include "engine/base/data_root.h"
#include "engine/base/file.h"
#include "tests/cli/program.h"
#include "tests/cli/trace_table.h"

namespace lensproof::bounds_test {

// Rows go out as they are traced: of ten times as many rays the program holds the file's text alone, 30 bytes a
// ray where a row of each surface took 32 KB, so that 4 MiB are room enough for 9000 more.
TEST(Bounds, TraceHoldsNoRows) {
    const Workplace place;
    const auto peak = [&](int rays) {
        std::string text = kRayHeader;
        for (int i = 0; i < rays; ++i) {
            text += kAxialRay;
        }
        place.file("rays.csv", text);
        const Outcome outcome = place.run({"trace", "tessar", "--rays", "rays.csv", "-o", "out.csv", "--json", "out"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return outcome.peak_kib;
    };
    EXPECT_LT(peak(10'000), peak(1'000) + 4096);
}

// A lens of which a rim lets a nanometre through has no light to speak of, and is searched for it no longer than a
// lens that has: some seconds for all fields, where it took seven minutes.
TEST(Bounds, AnalysisOfAClosedRimEnds) {
    const Workplace place;
    std::string lens = read_file(data_root() / "lenses/tessar.toml");
    const std::string rim = "semi_diameter_mm = 19.2";
    place.file("lens.toml", lens.replace(lens.find(rim), rim.size(), "semi_diameter_mm = 1e-9"));
    const auto begin = std::chrono::steady_clock::now();
    const Outcome outcome = place.run({"analyze", "lens.toml"});
    EXPECT_GE(outcome.status, 0) << outcome.err;
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
}

}  // namespace lensproof::bounds_test
