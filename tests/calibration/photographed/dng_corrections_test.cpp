// A maker's corrections as they are read from a DNG, against the specification's own mapping of pixels.
#include "calibration/photographed/dng_corrections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/calibration/photographed/dng_file.h"
#include "tests/calibration/photographed/entry_file.h"
#include "tests/complaint.h"

namespace lensproof::calibration::dng_corrections_test {

using namespace synthetic;

constexpr double kPixel_mm = 36.0 / 6000.0;
constexpr std::array<double, 2> kCentre{0.51, 0.48};
constexpr std::array<std::array<double, 4>, 3> kRadial{
    {{1.0101, -0.0202, 0.0031, -0.0007}, {1.01, -0.02, 0.003, -0.0005}, {1.0098, -0.0199, 0.0029, -0.0006}}};
constexpr std::array<double, 5> kGain{0.31, 0.22, -0.13, 0.14, -0.05};

std::vector<double> warp_values(const std::array<std::array<double, 4>, 3>& radial, double tangential = 0.0) {
    std::vector<double> values;
    for (const auto& plane : radial) {
        values.insert(values.end(), plane.begin(), plane.end());
        values.insert(values.end(), {tangential, 0.0});
    }
    values.insert(values.end(), kCentre.begin(), kCentre.end());
    return values;
}

std::string gain_opcode() {
    return opcode(3, big_endian(kGain) + big_endian(kCentre));
}

std::string lens_opcodes() {
    return opcode_list({opcode(9, "a gain map, passed over"), gain_opcode(), warp_opcode(3, warp_values(kRadial))});
}

PhotographedLens read(const Dng& dng, std::optional<double> crop_factor = {}) {
    const TestFolder folder;
    return read_dng_corrections(written(folder, "a.dng", dng_bytes(dng)), crop_factor);
}

/// Digital Negative Specification 1.4, chapter 7: the optical centre, and the distance to the farthest corner, px.
struct Specified {
    double x = kCentre[0] * (6000.0 - 1.0);
    double y = kCentre[1] * (4000.0 - 1.0);
    double m = std::hypot(std::max(x, 5999.0 - x), std::max(y, 3999.0 - y));

    /// The source of the plane's pixel at the distance `px` from the centre, along x.
    [[nodiscard]] double source(std::size_t plane, double px) const {
        const auto& k = kRadial[plane];
        const double d = px / m;
        return m * (k[0] + k[1] * std::pow(d, 2) + k[2] * std::pow(d, 4) + k[3] * std::pow(d, 6)) * d;
    }
};

TEST(DngCorrections, ImageWhereTheSpecificationTakesPixelsFrom) {
    Dng dng{.opcodes = lens_opcodes()};
    dng.photo = with_focal_plane(dng.photo);
    const PhotographedLens lens = read(dng);
    EXPECT_EQ(lens.source, "dng");
    EXPECT_EQ(lens.maker, "Own");
    EXPECT_EQ(lens.model, "Own 50mm f/2");
    EXPECT_EQ(lens.focal_length_mm, 50.0);
    EXPECT_NEAR(lens.crop_factor, 1.0, 1e-12);
    EXPECT_EQ(lens.aspect_ratio, 1.5);
    EXPECT_TRUE(lens.remarks.empty());
    ASSERT_TRUE(lens.lateral_colour);
    const Specified specified;
    for (const double px : {1.0, 500.0, 2000.0, 3500.0}) {
        const double green = specified.source(1, px) * kPixel_mm;
        // Two sums of four terms in another order, and for colours an inverse to 2⁻⁶⁰ of 90 mm.
        EXPECT_NEAR(photographed_radius(lens, px * kPixel_mm), green, 1e-12);
        EXPECT_NEAR(green + channel_shift(lens, lens.lateral_colour->red, green), specified.source(0, px) * kPixel_mm,
                    1e-12);
        EXPECT_NEAR(green + channel_shift(lens, lens.lateral_colour->blue, green), specified.source(2, px) * kPixel_mm,
                    1e-12);
    }
    ASSERT_EQ(lens.vignetting.size(), 1U);
    EXPECT_EQ(lens.vignetting[0].f_number, 8.0);
    for (const double fraction : {0.0, 0.4, 1.0}) {
        const double r = fraction * 0.5 * std::hypot(6000.0, 4000.0) / specified.m;
        double gain = 1.0;
        for (int i = 0; i < 5; ++i) {
            gain += kGain[static_cast<std::size_t>(i)] * std::pow(r, 2 * (i + 1));
        }
        EXPECT_NEAR(lens.vignetting[0].brightness(fraction) * gain, 1.0, 1e-14);
    }
}

TEST(DngCorrections, TakeTheSensorsSizeFromWhatThereIs) {
    Dng dng{.opcodes = lens_opcodes()};
    EXPECT_EQ(read(dng, 1.5).crop_factor, 1.5);
    dng.photo.insert(dng.photo.begin() + 2,
                     TiffEntry{.tag = 0xA405, .type = 3, .count = 1, .value = little_endian(80, 2)});
    EXPECT_NEAR(read(dng).crop_factor, 1.6, 1e-12);
    dng.photo = with_focal_plane(dng.photo);
    EXPECT_NEAR(read(dng).crop_factor, 1.0, 1e-12);
    dng.photo = {kPixelsACentimetre, kCentimetre};
    EXPECT_NEAR(read(dng).crop_factor, 1.0, 1e-12);
    EXPECT_EQ(read(dng).model, "a.dng");
}

TEST(DngCorrections, SayWhatTheyLeaveOut) {
    Dng dng{.opcodes = opcode_list({warp_opcode(3, warp_values(kRadial, 1e-4)), gain_opcode()})};
    dng.photo.erase(dng.photo.begin());
    const PhotographedLens lens = read(dng, 1.0);
    ASSERT_EQ(lens.remarks.size(), 2U);
    EXPECT_TRUE(says(lens.remarks[0], "tangential"));
    EXPECT_TRUE(says(lens.remarks[1], "f-number"));
    EXPECT_TRUE(lens.vignetting.empty());
    // One plane for all colours says nothing of their shifts.
    std::vector<double> one = warp_values(kRadial);
    one.erase(one.begin(), one.begin() + 12);
    EXPECT_FALSE(read({.opcodes = opcode_list({warp_opcode(1, one)})}, 1.0).lateral_colour);
}

TEST(DngCorrections, RefuseWhatTheyCannotRead) {
    const TestFolder folder;
    const auto refused = [&](const std::string& bytes, const std::string& words, std::optional<double> crop = 1.0) {
        const std::filesystem::path file = written(folder, "a.dng", bytes);
        const std::string said = complaint_about([&] { read_dng_corrections(file, crop); });
        EXPECT_TRUE(says(said, "a.dng"));
        EXPECT_TRUE(says(said, words));
    };
    const auto of_opcodes = [](const std::vector<std::string>& opcodes) {
        return dng_bytes({.opcodes = opcode_list(opcodes)});
    };
    const std::string warp = warp_opcode(3, warp_values(kRadial));
    refused("no picture", "is no DNG");
    refused("", "is no DNG");
    refused(dng_bytes({}), "corrects nothing of its lens");
    refused(of_opcodes({opcode(9, "x")}), "corrects nothing of its lens");
    refused(of_opcodes({warp}), "--crop-factor", std::nullopt);
    refused(of_opcodes({warp, warp}), "OpcodeList3: WarpRectilinear comes twice");
    refused(of_opcodes({opcode(2, "x")}), "WarpFisheye");
    refused(of_opcodes({opcode(14, "x")}), "WarpRectilinear2");
    refused(of_opcodes({opcode(6, "sixteen bytes..."), warp}), "TrimBounds");
    refused(of_opcodes({warp_opcode(2, warp_values(kRadial))}), "2 planes, expected 1 or 3");
    refused(of_opcodes({opcode(3, big_endian(kGain) + big_endian(kCentre) + "x")}), "1 bytes too many");
    refused(of_opcodes({warp.substr(0, warp.size() - 9)}), "ends 9 bytes early");
    refused(of_opcodes({opcode(3, big_endian(kGain))}), "ends 8 bytes early");
    std::array<std::array<double, 4>, 3> bad = kRadial;
    bad[1][2] = std::numeric_limits<double>::quiet_NaN();
    refused(of_opcodes({warp_opcode(3, warp_values(bad))}), "nan");
    bad[1] = {0.0, 1.0, 0.0, 0.0};
    refused(of_opcodes({warp_opcode(3, warp_values(bad))}), "magnifies by 0");
    const std::array<double, 5> dark{-5.0};
    refused(of_opcodes({opcode(3, big_endian(dark) + big_endian(kCentre))}), "multiplies the corner");
    const std::array<double, 2> outside{0.5, 1.5};
    refused(of_opcodes({opcode(3, big_endian(kGain) + big_endian(outside))}), "centre is at 1.5");
}

// Cut anywhere, a file is refused by name or, where only its last statements are gone, read.
TEST(DngCorrections, ACutFileIsNoCrash) {
    const TestFolder folder;
    Dng dng{.opcodes = lens_opcodes()};
    dng.photo = with_focal_plane(dng.photo);
    const std::string whole = dng_bytes(dng);
    int refusals = 0;
    for (std::size_t size = 0; size < whole.size(); size += 3) {
        const std::filesystem::path file = written(folder, "cut.dng", whole.substr(0, size));
        const std::string said = complaint_about([&] { read_dng_corrections(file); });
        refusals += said.empty() ? 0 : 1;
        EXPECT_TRUE(said.empty() || says(said, "cut.dng"));
    }
    EXPECT_GT(refusals, 100);
}

}  // namespace lensproof::calibration::dng_corrections_test
