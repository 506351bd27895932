// The command `trace --precision float`: the error that it reports, against the rows that it writes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/cli/program.h"
#include "tests/cli/trace_table.h"
#include "tests/complaint.h"

namespace lensproof::trace_float_test {

using Json = nlohmann::json;

constexpr double kTessarMm = 119.451;  // from its first vertex to the image plane

Outcome trace_in(const Workplace& place, const std::string& precision, bool reverse,
                 const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"trace", "tessar", "--rays", "rays.csv", "--precision", precision};
    arguments.insert(arguments.end(), more.begin(), more.end());
    if (reverse) {
        arguments.emplace_back("--reverse");
    }
    return place.run(arguments);
}

double distance_um(const Json& a, const Json& b) {
    const Triple p = a["point_mm"];
    const Triple q = b["point_mm"];
    return 1e3 * std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

/// Three rays: two that pass and one that misses; in reverse, from the sensor.
std::string rays(bool reverse) {
    return std::string(kRayHeader) + (reverse ? "a,1,2,119.451,0.01,-0.02,-1,587.5618\nb,0,5,119.451,0,0,-1,486.1\n"
                                                "miss,0,90,119.451,0,0,-1,550\n"
                                              : "a,3,11,-10,0.01,-0.02,1,587.5618\nb,1,2,-20,0.1,0,1,486.1\n"
                                                "miss,0,90,-10,0,0,1,550\n");
}

// The rows hold every digit of either precision, so their distances are those reported, but for the rounding of double.
void expect_error_of_rows(bool reverse) {
    const Workplace place;
    place.file("rays.csv", rays(reverse));
    const Json floats = Json::parse(trace_in(place, "float", reverse, {"--json", "-"}).out);
    const Json doubles = Json::parse(trace_in(place, "double", reverse, {"--json", "-"}).out);
    ASSERT_EQ(floats["rows"].size(), doubles["rows"].size());
    double largest_um = 0.0;
    double at_end_um = 0.0;
    double sum_of_squares = 0.0;
    int points = 0;
    for (std::size_t i = 0; i < floats["rows"].size(); ++i) {
        const Json& row = floats["rows"][i];
        if (row["status"] == "missed") {
            continue;  // no point
        }
        const double um = distance_um(row, doubles["rows"][i]);
        ++points;
        sum_of_squares += um * um;
        largest_um = std::max(largest_um, um);
        if (row["surface"] == (reverse ? "1" : "image")) {
            at_end_um = std::max(at_end_um, um);
        }
    }
    const Json& error = floats["float_error"];
    const Json& at_end = error[reverse ? "first_surface" : "image_plane"];
    EXPECT_NEAR(at_end["largest_um"].get<double>(), at_end_um, 1e-10);
    EXPECT_EQ(at_end["points"], 2);
    EXPECT_NEAR(error["all_points"]["largest_um"].get<double>(), largest_um, 1e-10);
    EXPECT_NEAR(error["all_points"]["rms_um"].get<double>(), std::sqrt(sum_of_squares / points), 1e-10);
    EXPECT_EQ(error["all_points"]["points"], points);
    EXPECT_EQ(error["rays"], 3);
    EXPECT_EQ(error["other_statuses"], 0);
    EXPECT_NEAR(error["system_length_mm"].get<double>(), kTessarMm, 1e-12);
    EXPECT_NEAR(error["bound_um"].get<double>(), 1e-3 * kTessarMm, 1e-15);  // 1e-3 µm a mm
    EXPECT_GT(at_end_um, 0.0);
    EXPECT_LT(at_end_um, 1e-3 * kTessarMm);
    EXPECT_FALSE(doubles.contains("float_error"));
}

TEST(TraceInFloat, ReportsTheErrorOfItsRows) {
    expect_error_of_rows(false);
}

TEST(TraceInFloat, ReportsItInReverseToo) {
    expect_error_of_rows(true);
}

TEST(TraceInFloat, SaysSoOnStandardErrorUnlessQuiet) {
    const Workplace place;
    place.file("rays.csv", rays(false));
    const Outcome loud = trace_in(place, "float", false, {"-o", "out.csv"});
    EXPECT_EQ(loud.status, 0);
    EXPECT_TRUE(says(loud.err, "float against double"));
    EXPECT_EQ(loud.out, "");
    EXPECT_EQ(trace_in(place, "float", false, {"-o", "out.csv", "--quiet"}).err, "");
    EXPECT_EQ(trace_in(place, "double", false, {"-o", "out.csv"}).err, "");
}

// From ten kilometres away the rounding of a float's direction, 4e-9, moves the ray by 40 µm: far over what is allowed;
// said, and no failure.
TEST(TraceInFloat, AnErrorOverItsBoundIsNoFailure) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + "far,1000003,2,-1e7,-0.1,0,1,550\n");
    const Outcome outcome = trace_in(place, "float", false, {"--json", "-"});
    EXPECT_EQ(outcome.status, 0);
    const Json error = Json::parse(outcome.out)["float_error"];
    EXPECT_GT(error["all_points"]["largest_um"], error["bound_um"]);
}

}  // namespace lensproof::trace_float_test
