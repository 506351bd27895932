// tests/cli/trace_numbers_test.cpp — the command `trace` against rays traced with 50 digits, for seven lenses.
//
// tests/validation/reference_numbers/README.md says how they were made.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/cli/program.h"
#include "tests/cli/reference_numbers.h"

namespace lensproof::trace_numbers_test {

using Json = nlohmann::json;

/// A rounding of a number as large as the way from the ray's origin, mm.
double rounding_of_distance(const Json& ray) {
    const Triple origin = triple(ray["origin"]);
    return std::numeric_limits<double>::epsilon() * std::hypot(origin[0], origin[1], origin[2]);
}

/// What it costs, mm, that the direction of a ray from afar is made a unit vector in double precision: half an ulp at
/// the first surface, and up to 7 times that inside the lens (`fisheye-220` spreads neighbouring rays so far).
double cost_of_distance(const Json& ray) {
    constexpr double kSpread = 7.0;
    return 0.5 * kSpread * rounding_of_distance(ray);
}

double point_tolerance(const Json& ray) {
    return 1e-9 + cost_of_distance(ray);
}

/// The path from afar is rounded once more, by half an ulp, at each of at most 24 surfaces and the image plane.
double path_tolerance(const Json& ray) {
    return point_tolerance(ray) + 13.0 * rounding_of_distance(ray);
}

/// A normal turns by the shift times the curvature, which is below 0.2 / mm in all of these lenses.
double direction_tolerance(const Json& ray) {
    return 1e-12 + 0.2 * cost_of_distance(ray);
}

std::string ray_id(std::size_t i) {
    return "ray" + std::to_string(i);
}

std::string fan_id(std::size_t i) {
    return "fan" + std::to_string(i);
}

/// A lens's numbers, and what the command says of all of its rays in one go.
class TracedNumbers {
  public:
    explicit TracedNumbers(const std::string& lens) : numbers_(reference_numbers(lens)) {
        std::string csv = kRayHeader;
        const Json& rays = numbers_["rays"];
        for (std::size_t i = 0; i < rays.size(); ++i) {
            csv +=
                ray_line(ray_id(i), triple(rays[i]["origin"]), triple(rays[i]["direction"]), rays[i]["wavelength_nm"]);
        }
        const Json& fan = numbers_["fan"];
        for (std::size_t i = 0; i < fan["points"].size(); ++i) {
            csv +=
                ray_line(fan_id(i), triple(fan["points"][i]["origin"]), triple(fan["direction"]), fan["wavelength_nm"]);
        }
        const Workplace place;
        place.file("rays.csv", csv);
        const Outcome outcome =
            place.run({"trace", numbered_lens(lens), "--rays", "rays.csv", "--no-clip", "-o", "out.csv"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        rows_ = read_trace_rows(place.content("out.csv"));
    }

    [[nodiscard]] const Json& numbers() const { return numbers_; }
    [[nodiscard]] const std::vector<TraceRow>& rows(const std::string& id) const { return rows_.at(id); }

  private:
    Json numbers_;
    TraceRows rows_;
};

/// The first surface, from 1, that the ray met beyond its rim.
Json first_clipped(const std::vector<TraceRow>& rows) {
    for (const TraceRow& row : rows) {
        if (row.status == "clipped" || row.status == "stopped") {
            return std::stoi(row.surface);
        }
    }
    return nullptr;
}

void expect_same(const std::vector<TraceRow>& rows, const Json& ray) {
    const Json& surfaces = ray["surfaces"];
    ASSERT_EQ(rows.size(), surfaces.size() + 1);  // the last row: the image plane, or where the ray ended
    const double tolerance = point_tolerance(ray);
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        SCOPED_TRACE("surface " + rows[i].surface);
        EXPECT_EQ(rows[i].surface, std::to_string(i + 1));
        expect_near(rows[i].point, triple(surfaces[i]), tolerance);
        expect_near(rows[i].direction, triple(surfaces[i], 3), direction_tolerance(ray));
        EXPECT_NEAR(rows[i].optical_path, surfaces[i][6].get<double>(), path_tolerance(ray));
    }
    if (ray["status"] == "ok") {
        EXPECT_EQ(rows.back().surface, "image");
        EXPECT_NEAR(rows.back().point[0], ray["image"][0].get<double>(), tolerance);
        EXPECT_NEAR(rows.back().point[1], ray["image"][1].get<double>(), tolerance);
        EXPECT_NEAR(rows.back().optical_path, ray["image"][2].get<double>(), path_tolerance(ray));
        EXPECT_EQ(first_clipped(rows), ray["clipped"]);
    } else {
        EXPECT_EQ(rows.back().surface, std::to_string(surfaces.size() + 1));
        EXPECT_EQ(rows.back().status, ray["status"].get<std::string>());
    }
}

class TraceNumbers : public testing::TestWithParam<const char*> {};

TEST_P(TraceNumbers, EverySurfaceOfEveryRay) {
    const TracedNumbers traced(GetParam());
    const Json& rays = traced.numbers()["rays"];
    int ended = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        SCOPED_TRACE(ray_id(i));
        expect_same(traced.rows(ray_id(i)), rays[i]);
        ended += rays[i]["status"] == "ok" ? 0 : 1;
    }
    EXPECT_GE(rays.size(), 15);
    EXPECT_EQ(ended, 2) << "one that misses, one that is totally reflected";
}

TEST_P(TraceNumbers, FansErrFromTheChiefRay) {
    const TracedNumbers traced(GetParam());
    const Json& fan = traced.numbers()["fan"];
    const double chief_y = fan["chief_y_mm"];
    for (std::size_t i = 0; i < fan["points"].size(); ++i) {
        SCOPED_TRACE(fan_id(i));
        const TraceRow& image = traced.rows(fan_id(i)).back();
        const Json& error = fan["points"][i]["error_mm"];
        EXPECT_NEAR(image.point[0], error[0].get<double>(), 1e-9);
        EXPECT_NEAR(image.point[1] - chief_y, error[1].get<double>(), 1e-9);
    }
    EXPECT_GE(fan["points"].size(), 12);
}

INSTANTIATE_TEST_SUITE_P(Lens, TraceNumbers, testing::ValuesIn(kNumberedLenses),
                         [](const auto& lens) { return test_name(lens.param); });

}  // namespace lensproof::trace_numbers_test
