// tests/cli/trace_polarised_test.cpp — `lensproof trace --polarised` against Fresnel's closed forms and reciprocity.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/cli/program.h"
#include "tests/cli/trace_table.h"

namespace lensproof::trace_polarised_test {

using Json = nlohmann::json;

constexpr double kIndex = 1.6;
constexpr double kRadian = 180.0 / 3.14159265358979323846;

// A path of four surfaces is some thirty operations on numbers of size 1.
constexpr double kRounding = 1e-13;

std::string flat(const char* tilt, double index) {
    return fmt::format(
        "  {{ radius_mm = inf, thickness_mm = 8.0, semi_diameter_mm = 20.0, n_d = {}, tilt_deg = {} }},\n", index,
        tilt);
}

/// Plates of `kIndex` in air, one for each tilt, and a stop.
std::string plates(const std::vector<const char*>& tilts) {
    std::string text = "name = \"plates\"\nsource = \"made up for a test\"\nsurfaces = [\n";
    for (const char* tilt : tilts) {
        text += flat(tilt, kIndex) + flat(tilt, 1.0);
    }
    return text + "  { stop = true, thickness_mm = 20.0, semi_diameter_mm = 20.0 },\n]\n";
}

/// A plate's two faces by Fresnel's equations in sines (Born & Wolf, §1.5.2, eqs. 35).
struct Plate {
    double s;
    double p;
};
Plate plate_at(double incidence) {
    const double inside = std::asin(std::sin(incidence) / kIndex);
    const double s = std::sin(2.0 * incidence) * std::sin(2.0 * inside) / std::pow(std::sin(incidence + inside), 2);
    return {s * s, std::pow(s / std::pow(std::cos(incidence - inside), 2), 2)};
}

/// The rows of one ray, with `more` on the command line.
Json rows_of(const std::string& lens, const std::string& ray, std::vector<std::string> more = {}) {
    const Workplace place;
    place.file("lens.toml", lens);
    place.file("rays.csv", kRayHeader + ray);
    std::vector<std::string> arguments{"trace", lens.find('\n') == std::string::npos ? lens : "lens.toml", "--rays",
                                       "rays.csv", "--polarised"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return place.json(arguments)["rows"];
}

std::vector<Json> on_image(const Json& rows) {
    std::vector<Json> last;
    for (const Json& row : rows) {
        if (row["surface"] == "image") {
            last.push_back(row);
        }
    }
    return last;
}

// Two plates on the axis whose planes of incidence are at φ: the second is a partial polariser for what the first left
// (Malus's law for both axes).
TEST(TracePolarised, SkewPlanesOfIncidence) {
    constexpr double kTilt = 50.0 / kRadian;
    const Plate first = plate_at(kTilt);
    for (const auto& [x_deg, y_deg] : {std::pair{0.0, 50.0}, {30.0, 35.0}}) {
        const double x = x_deg / kRadian;
        const double y = y_deg / kRadian;
        const Plate second = plate_at(std::acos(std::cos(x) * std::cos(y)));
        const double azimuth = std::atan2(std::sin(y), -std::sin(x) * std::cos(y));  // of the normal, from the first's
        const double cos2 = std::pow(std::cos(azimuth), 2);
        const std::string tilt = fmt::format("[{}, {}, 0.0]", x_deg, y_deg);
        const Json rows = rows_of(plates({"[50.0, 0.0, 0.0]", tilt.c_str()}), "a,0,0,-10,0,0,1,587.5618\n");
        const Json& plate = rows[1];
        EXPECT_NEAR(plate["sagittal_transmittance"], first.s, kRounding);  // across y–z, along x
        EXPECT_NEAR(plate["tangential_transmittance"], first.p, kRounding);
        EXPECT_NEAR(plate["degree_of_polarisation"], (first.p - first.s) / (first.p + first.s), kRounding);
        const Json& last = rows.back();
        EXPECT_EQ(last["surface"], "image");
        EXPECT_NEAR(last["polarised_transmittance"],
                    ((first.s * second.s + first.p * second.p) * cos2 +
                     (first.s * second.p + first.p * second.s) * (1.0 - cos2)) /
                        2.0,
                    kRounding)
            << tilt;
        EXPECT_NEAR(last["transmittance"], (first.s + first.p) * (second.s + second.p) / 4.0, 0.02);
    }
}

// At Brewster's angle nothing polarised in the plane of incidence is reflected: it passes whole, and no ghost has any.
TEST(TracePolarised, BrewstersAngle) {
    const double brewster = std::atan(kIndex);
    const double t_s = 4.0 * kIndex * kIndex / std::pow(1.0 + kIndex * kIndex, 2);
    std::string rays;
    for (const double azimuth : {0.0, 1.0, 2.5}) {
        rays += ray_line(
            "a", {1.0, -2.0, -1.0},
            {std::sin(brewster) * std::cos(azimuth), std::sin(brewster) * std::sin(azimuth), std::cos(brewster)},
            550.0);
    }
    const std::string plate = plates({"[0.0, 0.0, 0.0]"});
    const std::vector<Json> through = on_image(rows_of(plate, rays, {"--no-clip"}));
    const std::vector<Json> ghosts = on_image(rows_of(plate, rays, {"--no-clip", "--sequence", "2,1"}));
    ASSERT_EQ(through.size(), 3U);
    ASSERT_EQ(ghosts.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(through[i]["tangential_transmittance"], 1.0, kRounding);
        EXPECT_NEAR(through[i]["sagittal_transmittance"], t_s * t_s, kRounding);
        EXPECT_NEAR(through[i]["polarised_transmittance"], (1.0 + t_s * t_s) / 2.0, kRounding);
        EXPECT_NEAR(ghosts[i]["tangential_transmittance"], 0.0, kRounding);
        EXPECT_NEAR(ghosts[i]["sagittal_transmittance"], std::pow(t_s * (1.0 - t_s), 2), kRounding);
        EXPECT_NEAR(ghosts[i]["degree_of_polarisation"], 1.0, kRounding);
        const double averaged = std::pow((1.0 - t_s) / 2.0 * (1.0 + t_s) / 2.0, 2);
        EXPECT_NEAR(ghosts[i]["transmittance"], averaged, kRounding);
    }
}

// Of a real, coated lens's skew ray: both polarisations' mean is what unpolarised light leaves, at the first surface
// the average; fields stand across the ray and hold the power; and the way back lets as much pass.
TEST(TracePolarised, SkewRayOfATessar) {
    const std::vector<std::string> coated{"--coating", "mgf2"};
    const Json rows = rows_of("tessar", "a,9,-6,-20,-0.1,0.25,1,550\n", coated);
    ASSERT_EQ(rows.back()["surface"], "image");
    EXPECT_NEAR(rows[0]["polarised_transmittance"], rows[0]["transmittance"], kRounding);
    for (const Json& row : rows) {
        const double sagittal = row["sagittal_transmittance"];
        const double tangential = row["tangential_transmittance"];
        EXPECT_NEAR(row["polarised_transmittance"], (sagittal + tangential) / 2.0, kRounding);
        double power = 0.0;
        double along_real = 0.0;
        double along_imaginary = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const double real = row["tangential_field"][i][0];
            const double imaginary = row["tangential_field"][i][1];
            const double direction = row["direction"][i];
            power += real * real + imaginary * imaginary;
            along_real += real * direction;
            along_imaginary += imaginary * direction;
        }
        EXPECT_NEAR(power, tangential, kRounding);
        EXPECT_NEAR(along_real, 0.0, kRounding);
        EXPECT_NEAR(along_imaginary, 0.0, kRounding);
    }
    const Json& image = rows.back();
    EXPECT_GT(std::abs(image["sagittal_transmittance"].get<double>() - image["tangential_transmittance"].get<double>()),
              1e-3);  // or it would say nothing
    const Triple direction = triple(image["direction"]);
    const std::string back =
        ray_line("b", triple(image["point_mm"]), {-direction[0], -direction[1], -direction[2]}, 550);
    const Json reverse = rows_of("tessar", back, {"--coating", "mgf2", "--reverse"});
    EXPECT_EQ(reverse.back()["surface"], "1");
    EXPECT_NEAR(reverse.back()["polarised_transmittance"], image["polarised_transmittance"], 1e-12);
}

TEST(TracePolarised, AddsColumnsInEveryPrecision) {
    const Workplace place;
    place.file("rays.csv", std::string(kRayHeader) + "a,9,-6,-20,-0.1,0.25,1,550\nmiss,0,90,-10,0,0,1,550\n");
    const std::vector<std::string> arguments{"trace", "tessar", "--rays", "rays.csv"};
    const auto with = [&](const std::vector<std::string>& more) {
        std::vector<std::string> all = arguments;
        all.insert(all.end(), more.begin(), more.end());
        return cells_of(place.run(all).out);
    };
    const auto plain = with({});
    const auto doubles = with({"--polarised"});
    ASSERT_EQ(doubles.size(), plain.size());
    for (std::size_t row = 0; row < plain.size(); ++row) {
        EXPECT_EQ(std::vector(doubles[row].begin(), doubles[row].begin() + 11), plain[row]);
    }
    EXPECT_EQ(doubles[0][11], "polarised_transmittance");
    EXPECT_EQ(doubles[0][14], "degree_of_polarisation");
    EXPECT_EQ(doubles[9][1], "image");
    EXPECT_EQ(doubles.back()[10], "missed");
    EXPECT_EQ(std::stod(doubles.back()[11]), 1.0);
    for (const auto& [precision, tolerance] : {std::pair{"float", 1e-5}, {"extended", 1e-13}}) {
        const auto table = with({"--polarised", "--precision", precision});
        ASSERT_EQ(table.size(), plain.size()) << precision;
        for (std::size_t i = 11; i < 15; ++i) {
            EXPECT_NEAR(std::stod(table[9][i]), std::stod(doubles[9][i]), tolerance) << precision;
        }
    }
}

}  // namespace lensproof::trace_polarised_test
