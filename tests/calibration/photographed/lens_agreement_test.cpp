// What is found of two lenses whose difference is known.
#include "calibration/photographed/lens_agreement.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lensproof::calibration::lens_agreement_test {

constexpr double kFocal_mm = 50.0;

PhotographedLens full_frame(const RadialPolynomial& distortion) {
    PhotographedLens lens;
    lens.distortion_model = "ptlens";
    lens.distortion = distortion;
    return lens;
}

const PhotographedLens& barrel() {
    static const PhotographedLens lens = full_frame({1.012, 0.004, -0.02, 0.004, 0.0});
    return lens;
}

/// A field whose green is imaged at height(θ), red and blue at 1.001 and 0.999 of it.
template <class Height>
ImagedField field_of(const Height& height, double end_rad, int count = 400) {
    ImagedField field;
    for (int i = 0; i <= count; ++i) {
        const double angle = end_rad * i / count;
        const double green = height(angle);
        field.field_angle.push_back(angle);
        field.height_mm.push_back({1.001 * green, green, 0.999 * green});
    }
    const double slope = height(1e-6) / 1e-6;
    field.focal_length_mm = {1.001 * slope, slope, 0.999 * slope};
    return field;
}

// A simulated lens that is the photographed one of another focal length: no residual, and the scale is the ratio. The
// fit ends at 1e-12 of F, which is far below 1e-6 µm.
TEST(LensAgreement, TheSameLensHasNoResidual) {
    const ImagedField field =
        field_of([](double angle) { return photographed_radius(barrel(), kFocal_mm * std::tan(angle)); }, 0.43);
    const auto agreement = distortion_agreement(barrel(), field);
    ASSERT_TRUE(agreement);
    EXPECT_LT(agreement->residual.rms_um, 1e-6);
    EXPECT_NEAR(agreement->scale, 1.0, 1e-5);
    EXPECT_NEAR(agreement->reach, 1.0, 0.003);  // 400 steps
    EXPECT_EQ(agreement->photographed_percent.front()[0], 0.0);
    EXPECT_NEAR(agreement->photographed_percent.back()[1], agreement->simulated_percent.back()[1], 1e-4);
}

// A cubic k u³ that one focal length cannot follow leaves k √(4/175) of the half-diagonal's k: least squares of u³ by u
// over u from 0 to 1. Exact to first order in k.
TEST(LensAgreement, ACubicLeavesWhatALineCannotFollow) {
    constexpr double kCubic = 1e-4;
    const PhotographedLens ideal = full_frame({1.0, 0.0, 0.0, 0.0, 0.0});
    const double edge = ideal.half_diagonal_mm();
    const ImagedField field = field_of(
        [&](double angle) {
            const double u = kFocal_mm * std::tan(angle) / edge;
            return edge * (u + kCubic * u * u * u);
        },
        std::atan(edge / kFocal_mm), 4000);
    const double expected_um = 1e3 * edge * kCubic * std::sqrt(4.0 / 175.0);
    const auto agreement = distortion_agreement(ideal, field);
    ASSERT_TRUE(agreement);
    EXPECT_NEAR(agreement->residual.rms_um / expected_um, 1.0, 2e-3);
    EXPECT_NEAR(1e3 * departure_from_ideal(field, optics::Projection::rectilinear, edge) / expected_um, 1.0, 2e-3);
    // The photographed side of the same.
    const double unit = ideal.unit_mm() / edge;
    const PhotographedLens cubic = full_frame({1.0, 0.0, kCubic * unit * unit, 0.0, 0.0});
    EXPECT_NEAR(1e3 * departure_from_ideal(cubic) / expected_um, 1.0, 2e-3);
    EXPECT_LT(departure_from_ideal(ideal), 1e-9);
}

TEST(LensAgreement, AFisheyeIsComparedInItsOwnProjection) {
    PhotographedLens fisheye = full_frame({1.0, 0.0, 0.0, 0.0, 0.0});
    const auto equisolid = [](double angle) { return 2.0 * 15.0 * std::sin(0.5 * angle); };
    const ImagedField field = field_of(equisolid, 1.57);
    fisheye.projection = optics::Projection::equisolid;
    EXPECT_LT(distortion_agreement(fisheye, field)->residual.rms_um, 1e-6);
    fisheye.projection = optics::Projection::equidistant;
    EXPECT_GT(distortion_agreement(fisheye, field)->residual.rms_um, 100.0);
}

TEST(LensAgreement, SaysHowFarBothImage) {
    const auto rectilinear = [](double angle) { return kFocal_mm * std::tan(angle); };
    EXPECT_NEAR(distortion_agreement(barrel(), field_of(rectilinear, 0.2))->reach, kFocal_mm * std::tan(0.2) / 21.633,
                1e-3);
    EXPECT_FALSE(distortion_agreement(barrel(), field_of(rectilinear, 0.02)));
    // Folds back where 1 = 0.75 u²: at u = 1.155 units of 12 mm, imaged at 9.24 mm.
    const PhotographedLens folds = full_frame({1.0, 0.0, -0.25, 0.0, 0.0});
    EXPECT_NEAR(ideal_radius_covered(folds, 100.0), 12.0 * std::sqrt(4.0 / 3.0), 0.11);
    const auto agreement = distortion_agreement(folds, field_of(rectilinear, 0.4));
    ASSERT_TRUE(agreement);
    EXPECT_LT(agreement->reach, 0.7);
    PhotographedLens unmeasured = barrel();
    unmeasured.distortion_model.clear();
    EXPECT_FALSE(distortion_agreement(unmeasured, field_of(rectilinear, 0.4)));
}

// Red 0.1 % larger than green: h/1000, whose rms over h from 0 to h_end is h_end / 1000 √3.
TEST(LensAgreement, LateralColourIsTheDifferenceOfChannels) {
    PhotographedLens lens = barrel();
    const ImagedField field = field_of([](double angle) { return kFocal_mm * std::tan(angle); }, 0.4, 2000);
    EXPECT_FALSE(lateral_colour_agreement(lens, field));
    lens.lateral_colour = LateralColour{.red = ChannelScale{.v = 1.001}, .blue = ChannelScale{.v = 1.0}};
    const auto agreement = lateral_colour_agreement(lens, field);
    ASSERT_TRUE(agreement);
    EXPECT_LT(agreement->red.residual.rms_um, 1e-6);
    EXPECT_NEAR(agreement->blue.residual.rms_um, field.largest_mm() / std::sqrt(3.0), 1e-2);
    EXPECT_NEAR(agreement->blue.simulated_um.back()[1], -field.largest_mm(), 1e-9);
}

}  // namespace lensproof::calibration::lens_agreement_test
