// tests/cli/analyze_numbers_test.cpp — the command `analyze` against seven lenses computed with 50 digits.
//
// tests/validation/reference_numbers/README.md says how the numbers were made and what each one means.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/cli/program.h"
#include "tests/cli/reference_numbers.h"

namespace lensproof::analyze_numbers_test {

using Json = nlohmann::json;

constexpr double kFirstOrder = 1e-10;         // relative; Seidel sums: of the largest surface's
constexpr double kHeight_mm = 1e-9;           // chief rays
constexpr double kFocus_mm = 1e-9;            // astigmatic foci
constexpr double kIllumination = 1e-6;        // relative: areas of beams and cones, and means over them
constexpr double kDistortion_percent = 1e-9;  // of heights of 1 mm and more, known to 1e-12 mm

std::string list(const std::vector<double>& values) {
    std::string text;
    for (const double value : values) {
        text += (text.empty() ? "" : ",") + exact(value);
    }
    return text;
}

/// What the command says of a lens at fields and at all of the reference's wavelengths.
Json analysis(const std::string& lens, const Json& numbers, const std::vector<double>& fields_deg) {
    return Workplace().json({"analyze", numbered_lens(lens), "--fields", list(fields_deg), "--wavelengths",
                             list(numbers["wavelengths_nm"])});
}

/// The number under a key; fails the test where there is none.
double number(const Json& object, const std::string& key) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number()) {
        ADD_FAILURE() << key << " is no number: " << object.dump();
        return std::nan("");
    }
    return *found;
}

void expect_first_order(const Json& numbers, const Json& found) {
    const std::string reference = exact(numbers["wavelengths_nm"][0]);
    EXPECT_EQ(exact(number(found, "reference_wavelength_nm")), reference);
    int compared = 0;
    for (const auto& [key, expected] : numbers["paraxial"][reference].items()) {
        const double value = expected;
        EXPECT_NEAR(number(found["paraxial"], key), value, kFirstOrder * std::abs(value)) << key;
        ++compared;
    }
    EXPECT_EQ(compared, 9);
    const double invariant = numbers["seidel"]["lagrange_invariant_mm"];
    EXPECT_NEAR(number(found["paraxial"], "lagrange_invariant_mm"), invariant, kFirstOrder * std::abs(invariant));
}

void expect_third_order(const Json& numbers, const Json& found) {
    const Json& seidel = numbers["seidel"];
    const Json& surfaces = found["seidel"]["surfaces"];
    ASSERT_EQ(surfaces.size(), seidel["surfaces"].size());
    const std::vector<std::string> keys = {"s1", "s2", "s3", "s4", "s5", "c1", "c2"};
    const std::size_t count = seidel["has_colour"].get<bool>() ? 7 : 5;
    for (std::size_t k = 0; k < count; ++k) {
        double largest = 0.0;
        for (const Json& surface : seidel["surfaces"]) {
            largest = std::max(largest, std::abs(surface[k].get<double>()));
        }
        for (std::size_t i = 0; i < surfaces.size(); ++i) {
            EXPECT_EQ(number(surfaces[i], "surface"), static_cast<double>(i + 1));
            EXPECT_NEAR(number(surfaces[i], keys[k]), seidel["surfaces"][i][k].get<double>(), kFirstOrder * largest)
                << keys[k] << " of surface " << i + 1;
        }
        EXPECT_NEAR(number(found["seidel"]["total"], keys[k]), seidel["total"][k].get<double>(), kFirstOrder * largest)
            << keys[k];
    }
}

void expect_chief_ray(const Json& expected, const Json& found) {
    EXPECT_NEAR(number(found, "chief_ray_height_mm"), number(expected, "chief_ray_height_mm"), kHeight_mm);
    EXPECT_NEAR(number(found, "lateral_colour_um"), number(expected, "lateral_colour_um"), 2e3 * kHeight_mm);
    EXPECT_NEAR(number(found, "tangential_focus_mm"), number(expected, "tangential_focus_mm"), kFocus_mm);
    EXPECT_NEAR(number(found, "sagittal_focus_mm"), number(expected, "sagittal_focus_mm"), kFocus_mm);
    if (expected.contains("distortion_percent")) {
        EXPECT_NEAR(number(found, "distortion_percent"), number(expected, "distortion_percent"), kDistortion_percent);
    }
}

void expect_light(const Json& expected, const Json& found) {
    for (const char* key : {"vignetting", "relative_illumination"}) {
        const double value = number(expected, key);
        EXPECT_NEAR(number(found, key), value, kIllumination * value) << key;
    }
}

void expect_spot(const Json& expected, const Json& found) {
    const double rms_um = number(expected, "spot_rms_um");
    EXPECT_NEAR(number(found, "spot_rms_um"), rms_um, kIllumination * rms_um);
    ASSERT_TRUE(found["spot_centroid_mm"].is_array()) << found.dump();
    EXPECT_NEAR(found["spot_centroid_mm"][0].get<double>(), 0.0, 1e-3 * kIllumination * rms_um);
    EXPECT_NEAR(found["spot_centroid_mm"][1].get<double>(), number(expected, "spot_centroid_y_mm"),
                1e-3 * kIllumination * rms_um);
}

void expect_wavefront(const Json& expected, const Json& found) {
    const double rms = number(expected, "wavefront_rms_waves");
    EXPECT_NEAR(number(found, "wavefront_rms_waves"), rms, kIllumination * rms);
}

class AnalyzeNumbers : public testing::TestWithParam<const char*> {
  protected:
    const Json numbers_ = reference_numbers(GetParam());
};

TEST_P(AnalyzeNumbers, FirstAndThirdOrder) {
    const Json found = analysis(GetParam(), numbers_, {0.0, numbers_["seidel"]["field_deg"].get<double>()});
    ASSERT_TRUE(found.is_object());
    expect_first_order(numbers_, found);
    expect_third_order(numbers_, found);
}

TEST_P(AnalyzeNumbers, Fields) {
    const Json found = analysis(GetParam(), numbers_, numbers_["fields_deg"]);
    ASSERT_TRUE(found.is_object());
    const Json& rows = found["fields"];
    EXPECT_EQ(rows.size(), numbers_["fields"].size());
    for (const Json& expected : numbers_["fields"]) {
        const double field = expected["field_deg"];
        const double wavelength = expected["wavelength_nm"];
        SCOPED_TRACE(testing::Message() << field << " deg, " << wavelength << " nm");
        const auto row = std::ranges::find_if(rows, [&](const Json& r) {
            return std::abs(r["field_deg"].get<double>() - field) < 1e-9 && r["wavelength_nm"] == wavelength;
        });
        ASSERT_NE(row, rows.end());
        EXPECT_EQ((*row)["status"], "ok");
        expect_chief_ray(expected, *row);
        expect_light(expected, *row);
        expect_spot(expected, *row);
        expect_wavefront(expected, *row);
    }
}

INSTANTIATE_TEST_SUITE_P(Lens, AnalyzeNumbers, testing::ValuesIn(kNumberedLenses),
                         [](const auto& lens) { return test_name(lens.param); });

}  // namespace lensproof::analyze_numbers_test
