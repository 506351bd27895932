#include "engine/spectral/spectrum.h"

#include <gtest/gtest.h>

#include <string>

#include "engine/base/input_error.h"
#include "tests/complaint.h"

namespace lensproof::spectral::spectrum_test {

Spectrum line(double from_nm, double to_nm, double from_value, double to_value) {
    return {.wavelength_nm = {from_nm, to_nm}, .value = {from_value, to_value}};
}

std::string complaint_about_table(const std::string& text) {
    return complaint_about([&] { parse_spectra(text, "table.csv", {"a"}); });
}

TEST(Spectrum, IsALineBetweenSamplesAndZeroOutside) {
    const Spectrum s{.wavelength_nm = {400.0, 500.0, 520.0}, .value = {1.0, 3.0, 0.5}};
    EXPECT_EQ(s(400.0), 1.0);
    EXPECT_EQ(s(450.0), 2.0);
    EXPECT_EQ(s(500.0), 3.0);
    EXPECT_EQ(s(520.0), 0.5);
    EXPECT_EQ(s(399.999), 0.0);
    EXPECT_EQ(s(520.001), 0.0);
    EXPECT_EQ(Spectrum{}(500.0), 0.0);
}

// Two trapezoids: 100·(1 + 3)/2 + 20·(3 + 0.5)/2. Numbers of size 200 in a few operations: 1e-12 is some 40 ulp.
TEST(Spectrum, IntegralIsTheAreaUnderTheLines) {
    const Spectrum s{.wavelength_nm = {400.0, 500.0, 520.0}, .value = {1.0, 3.0, 0.5}};
    EXPECT_NEAR(integral(s), 235.0, 1e-12);
    EXPECT_NEAR(integral(s, 300.0, 450.0), 75.0, 1e-12);
    EXPECT_NEAR(integral(s, 437.0, 509.0) + integral(s, 509.0, 600.0) + integral(s, 0.0, 437.0), 235.0, 1e-12);
    EXPECT_EQ(integral(s, 600.0, 700.0), 0.0);
    EXPECT_EQ(integral(Spectrum{}), 0.0);
}

// ∫ (λ − 400)(λ − 450) dλ from 450 to 500, where both are: with u = λ − 450, ∫ u² + 50 u du = 50³/3 + 50³/2.
// Numbers of size 1e5 in some ten operations: 1e-9 is ample for rounding, and one part in 1e14 of a wrong rule.
TEST(Spectrum, IntegralOfProductIsExactForParabolas) {
    const Spectrum a = line(400.0, 500.0, 0.0, 100.0);
    const Spectrum b = line(450.0, 600.0, 0.0, 150.0);
    const double expected = 50.0 * 50.0 * 50.0 * (1.0 / 3.0 + 1.0 / 2.0);
    EXPECT_NEAR(integral_of_product(a, b), expected, 1e-9);
    EXPECT_NEAR(integral_of_product(b, a), expected, 1e-9);
    EXPECT_EQ(integral_of_product(a, line(500.0, 600.0, 1.0, 1.0)), 0.0);
    EXPECT_EQ(integral_of_product(a, Spectrum{}), 0.0);
}

TEST(Spectrum, ClippedIsTheSameWithinAndZeroOutside) {
    const Spectrum s{.wavelength_nm = {400.0, 500.0, 520.0}, .value = {1.0, 3.0, 0.5}};
    const Spectrum inside = clipped(s, 450.0, 600.0);
    EXPECT_EQ(inside.wavelength_nm, (std::vector{450.0, 500.0, 520.0}));
    EXPECT_EQ(inside.value, (std::vector{2.0, 3.0, 0.5}));
    EXPECT_TRUE(clipped(s, 530.0, 600.0).wavelength_nm.empty());
    EXPECT_TRUE(clipped(Spectrum{}, 400.0, 500.0).wavelength_nm.empty());
}

TEST(SpectrumFile, ReadsTheNamedColumnsInTheOrderAsked) {
    const std::vector<Spectrum> read = parse_spectra(
        "# source\r\nwavelength_nm, a ,b\r\n\r\n400,1,2\r\n# aside\r\n500, 3 ,-4e-1\r\n", "t.csv", {"b", "a"});
    ASSERT_EQ(read.size(), 2U);
    EXPECT_EQ(read[0].wavelength_nm, (std::vector{400.0, 500.0}));
    EXPECT_EQ(read[0].value, (std::vector{2.0, -0.4}));
    EXPECT_EQ(read[1].value, (std::vector{1.0, 3.0}));
}

TEST(SpectrumFile, MalformedTablesAreRefusedByLine) {
    const std::string head = "# source\nwavelength_nm,a\n";
    EXPECT_EQ(complaint_about_table(head + "400,1\n500,2\n"), "");
    EXPECT_EQ(complaint_about_table(head + "400,1\n500,two\n"), "table.csv:4: a is \"two\", expected a finite number");
    EXPECT_EQ(complaint_about_table(head + "400,1\n500,nan\n"), "table.csv:4: a is \"nan\", expected a finite number");
    EXPECT_EQ(complaint_about_table(head + "400,1\n500,\n"), "table.csv:4: a is \"\", expected a finite number");
    EXPECT_EQ(complaint_about_table(head + "400,1\n500,1 2\n"), "table.csv:4: a is \"1 2\", expected a finite number");
    EXPECT_EQ(complaint_about_table(head + "400,1\n500\n"),
              "table.csv:4: 1 cells, expected 2 as in the header: wavelength_nm,a");
    EXPECT_EQ(complaint_about_table(head + "500,1\n400,2\n"),
              "table.csv:4: wavelength_nm is \"400\", expected more than 500, as wavelengths ascend");
    EXPECT_EQ(complaint_about_table(head + "0,1\n400,2\n"),
              "table.csv:3: wavelength_nm is \"0\", expected more than 0, as wavelengths ascend");
    EXPECT_EQ(complaint_about_table(head + "400,1\n"), "table.csv: 1 rows of numbers, expected at least 2");
    EXPECT_EQ(complaint_about_table("wavelength_nm,b\n400,1\n500,1\n"),
              "table.csv:1: the header is \"wavelength_nm,b\", expected a column a in it");
    EXPECT_EQ(complaint_about_table("nm,a\n400,1\n500,1\n"),
              "table.csv:1: the first column is \"nm\", expected wavelength_nm");
    EXPECT_EQ(complaint_about_table("# only\n\n"), "table.csv: is empty, expected a table with a header");
    EXPECT_EQ(complaint_about_table(""), "table.csv: is empty, expected a table with a header");
}

TEST(SpectrumFile, AMissingFileIsAnInputError) {
    EXPECT_THROW(read_spectra(spectral_data("no-such-table.csv"), {"a"}), InputError);
}

}  // namespace lensproof::spectral::spectrum_test
