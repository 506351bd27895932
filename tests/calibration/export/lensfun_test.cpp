// Profiles written for lensfun, read and applied by lensfun itself.
#include "calibration/export/lensfun.h"

#include <gtest/gtest.h>
#include <lensfun/lensfun.h>

#include <array>
#include <memory>

#include "engine/base/input_error.h"
#include "tests/calibration/export/export_profile.h"

namespace lensproof::calibration::lensfun_test {

using namespace synthetic;

constexpr double kCrop = 1.534;
constexpr double kFocal_mm = 18.0;

// The first lens of an XML text, with its database.
struct ReadLens {
    std::unique_ptr<lfDatabase> database = std::make_unique<lfDatabase>();
    const lfLens* lens = nullptr;

    explicit ReadLens(const std::string& xml) {
        EXPECT_EQ(database->Load("memory", xml.c_str(), xml.size()), LF_NO_ERROR) << xml;
        const lfLens* const* lenses = database->GetLenses();
        lens = lenses != nullptr ? lenses[0] : nullptr;
    }
};

// lensfun's correction of a picture of the profile's size.
class Correction {
  public:
    Correction(const ReadLens& read, const Profile& profile, int flags, float aperture = 8.0F)
        : modifier_(read.lens, kCrop, profile.width_px, profile.height_px),
          enabled_(modifier_.Initialize(read.lens, LF_PF_F32, kFocal_mm, aperture, 1000.0F, 1.0F, read.lens->Type,
                                        flags, false)) {}

    [[nodiscard]] int enabled() const { return enabled_; }
    // Where the corrected picture's pixel comes from.
    Vec2d source(const Vec2d& corrected) {
        std::array<float, 2> out{};
        EXPECT_TRUE(modifier_.ApplyGeometryDistortion(static_cast<float>(corrected.x), static_cast<float>(corrected.y),
                                                      1, 1, out.data()));
        return {out[0], out[1]};
    }
    // Where red, green and blue of a pixel come from.
    std::array<Vec2d, 3> channels(const Vec2d& pixel) {
        std::array<float, 6> out{};
        EXPECT_TRUE(modifier_.ApplySubpixelDistortion(static_cast<float>(pixel.x), static_cast<float>(pixel.y), 1, 1,
                                                      out.data()));
        return {Vec2d{out[0], out[1]}, Vec2d{out[2], out[3]}, Vec2d{out[4], out[5]}};
    }
    // What light of 0.5 becomes at a pixel.
    double brightened(const Vec2d& pixel) {
        std::array<float, 3> colour{0.5F, 0.5F, 0.5F};
        EXPECT_TRUE(modifier_.ApplyColorModification(colour.data(), static_cast<float>(pixel.x),
                                                     static_cast<float>(pixel.y), 1, 1, LF_CR_3(RED, GREEN, BLUE),
                                                     sizeof colour));
        return colour[1];
    }

  private:
    lfModifier modifier_;
    int enabled_;
};

LensfunOptions options() {
    return {.crop_factor = kCrop, .focal_length_mm = kFocal_mm, .f_number = 8.0, .maker = "A & B", .model = "18 <mm>"};
}

// The corrected pixel of a direction: the ideal projection about the same centre.
Vec2d corrected_pixel(const Profile& profile, const LensfunExport& result, const Vec3d& direction) {
    const double lateral = std::hypot(direction.x, direction.y);
    const double radius =
        result.corrected_focal_length_px * *ideal_radius(result.type, std::atan2(lateral, direction.z));
    const Vec2d centre = centre_px(profile.geometry->model);
    const double scale = lateral > 0.0 ? radius / lateral : 0.0;
    return {centre.x + scale * direction.x, centre.y + scale * direction.y};
}

// The largest distance between lensfun's source pixel and the profile's, over the covered frame.
double largest_difference(const Profile& profile, const LensfunExport& result) {
    const ReadLens read(result.xml);
    Correction correction(read, profile, LF_MODIFY_DISTORTION);
    EXPECT_EQ(correction.enabled(), LF_MODIFY_DISTORTION);
    double largest = 0.0;
    for (const Vec2d& pixel : covered_pixels(profile)) {
        const Vec3d direction = *unproject(profile.geometry->model, pixel);
        const Vec2d source = correction.source(corrected_pixel(profile, result, direction));
        largest = std::max(largest, std::hypot(source.x - pixel.x, source.y - pixel.y));
    }
    return largest;
}

// lensfun computes in floats: 7 digits of coordinates up to 1500 px through some ten operations, 2e-3 px at most.
constexpr double kFloat_px = 2e-3;

TEST(ExportLensfun, AModelThatPoly5CanSayIsSaidExactly) {
    const Profile profile = profile_of(BrownConrady{{1900.0, 761.0, 493.0, -0.12, 0.03, 0.0, 0.0, 0.0}}, 1500, 1000);
    const LensfunExport result = lensfun_export(profile, options());
    EXPECT_EQ(result.type, optics::Projection::rectilinear);
    EXPECT_EQ(result.distortion_model, "poly5");
    EXPECT_LT(result.largest_difference_px, 1e-6);
    EXPECT_NEAR(result.corrected_focal_length_px, 1900.0, 1e-6);
    EXPECT_LT(largest_difference(profile, result), kFloat_px);
}

// Whatever is approximated, the stated difference is what the library itself shows; portrait frames too.
TEST(ExportLensfun, TheStatedDifferenceIsTheLibrarysOwn) {
    for (const Profile& profile :
         {profile_of(perspective_camera(), 640, 480), profile_of(fisheye_camera(), 640, 480),
          profile_of(BrownConrady{{1100.0, 370.0, 560.0, 0.08, -0.02, 0.05, 0.001, 0.0}}, 750, 1100),
          profile_of(Division{{820.0, 318.5, 243.0, -0.12, 0.0}}, 640, 480),
          profile_of(Stereographic{{260.0, 322.0, 236.0, -0.02, 0.003, 0.0}}, 640, 480),
          profile_of(Equisolid{{260.0, 322.0, 236.0, -0.02, 0.003, 0.004}}, 640, 480),
          profile_of(Spline{{260.0, 322.0, 236.0, 0.001, 0.002, -0.003, -0.01, -0.015, -0.02, -0.03, -0.04, -0.05,
                             -0.06, -0.07, 1.4, 0.0}},
                     640, 480)}) {
        const LensfunExport result = lensfun_export(profile, options());
        SCOPED_TRACE(result.notes.front());
        EXPECT_LT(result.largest_difference_px, 3.0);  // the tangential terms alone move a corner by more than 1 px
        // The test's lattice is coarser than the exporter's, which includes it nowhere: up to 5 % less may be found.
        const double found = largest_difference(profile, result);
        EXPECT_LT(found, result.largest_difference_px + kFloat_px);
        EXPECT_GT(found, 0.7 * result.largest_difference_px - kFloat_px);
    }
}

// Without tangential terms the radial fits are good to hundredths of a pixel, on each type that can say the field.
TEST(ExportLensfun, EveryTypeFollowsAModerateLens) {
    const Profile profile = profile_of(BrownConrady{{820.0, 318.5, 243.0, -0.24, 0.09, -0.01, 0.0, 0.0}}, 640, 480);
    for (const optics::Projection type : optics::kProjections) {
        LensfunOptions chosen = options();
        chosen.type = type;
        const LensfunExport result = lensfun_export(profile, chosen);
        SCOPED_TRACE(result.notes.front());
        EXPECT_LT(result.largest_difference_px, 0.1);
        EXPECT_LT(largest_difference(profile, result), result.largest_difference_px + kFloat_px);
    }
}

TEST(ExportLensfun, AFisheyeIsWrittenAsOne) {
    const LensfunExport result = lensfun_export(profile_of(fisheye_camera(), 640, 480), options());
    EXPECT_EQ(ReadLens(result.xml).lens->Type, LF_FISHEYE);
    EXPECT_NE(result.xml.find("<type>fisheye</type>"), std::string::npos);
}

// Red 0.2 % larger than green, blue by a cubic: read back as displacements along the radius.
TEST(ExportLensfun, ChromaticShiftComesBack) {
    Profile profile = profile_of(BrownConrady{{1900.0, 761.0, 493.0, -0.12, 0.03, 0.0, 0.0, 0.0}}, 1500, 1000);
    const double unit = half_diagonal_px(profile);
    const auto red = [&](double h) { return 0.002 * h * unit; };
    const auto blue = [&](double h) { return -0.9 * h + 1.7 * h * h * h; };
    profile.curves["chromatic_shift_R_px"] = curve_of(red);
    profile.curves["chromatic_shift_B_px"] = curve_of(blue);
    const ReadLens read(lensfun_export(profile, options()).xml);
    Correction correction(read, profile, LF_MODIFY_TCA);
    ASSERT_EQ(correction.enabled(), LF_MODIFY_TCA);
    const Vec2d centre = centre_px(profile.geometry->model);
    for (const Vec2d& pixel : covered_pixels(profile)) {
        const auto [r, g, b] = correction.channels(pixel);
        const double radius = std::hypot(pixel.x - centre.x, pixel.y - centre.y);
        EXPECT_NEAR(std::hypot(g.x - pixel.x, g.y - pixel.y), 0.0, kFloat_px);
        EXPECT_NEAR(std::hypot(r.x - centre.x, r.y - centre.y) - radius, red(radius / unit), kFloat_px);
        EXPECT_NEAR(std::hypot(b.x - centre.x, b.y - centre.y) - radius, blue(radius / unit), kFloat_px);
    }
}

// A linear shift is written as `linear`.
TEST(ExportLensfun, ALinearShiftNeedsNoCubic) {
    Profile profile = profile_of(perspective_camera(), 640, 480);
    profile.curves["chromatic_shift_R_px"] = curve_of([](double h) { return 0.8 * h; });
    profile.curves["chromatic_shift_B_px"] = curve_of([](double h) { return -0.3 * h; });
    EXPECT_NE(lensfun_export(profile, options()).xml.find("tca model=\"linear\""), std::string::npos);
}

// V = 1 − 0.4 r² + 0.1 r⁴ is in the family of `pa`: lensfun divides by it, up to its float tables.
TEST(ExportLensfun, VignettingIsTakenOff) {
    Profile profile = profile_of(BrownConrady{{1900.0, 761.0, 493.0, -0.12, 0.03, 0.0, 0.0, 0.0}}, 1500, 1000);
    const auto light = [](double h) { return 1.0 - 0.4 * h * h + 0.1 * h * h * h * h; };
    profile.curves["vignetting_G"] = curve_of(light);
    const LensfunExport result = lensfun_export(profile, options());
    const ReadLens read(result.xml);
    Correction correction(read, profile, LF_MODIFY_VIGNETTING);
    ASSERT_EQ(correction.enabled(), LF_MODIFY_VIGNETTING);
    const Vec2d centre = centre_px(profile.geometry->model);
    for (const Vec2d& pixel : covered_pixels(profile)) {
        const double height = std::hypot(pixel.x - centre.x, pixel.y - centre.y) / half_diagonal_px(profile);
        EXPECT_NEAR(correction.brightened(pixel), 0.5 / light(height), 1e-5);
    }
    LensfunOptions without = options();
    without.f_number.reset();
    EXPECT_EQ(lensfun_export(profile, without).xml.find("<vignetting"), std::string::npos);
}

TEST(ExportLensfun, NamesSurviveAndAreNoMarkup) {
    const ReadLens read(lensfun_export(profile_of(perspective_camera(), 640, 480), options()).xml);
    ASSERT_NE(read.lens, nullptr);
    EXPECT_STREQ(read.lens->Maker, "A & B");
    EXPECT_STREQ(read.lens->Model, "18 <mm>");
    EXPECT_FLOAT_EQ(read.lens->CropFactor, kCrop);
}

TEST(ExportLensfun, WithoutACameraModelThereIsNothingToWrite) {
    Profile profile = profile_of(perspective_camera(), 640, 480);
    profile.geometry.reset();
    profile.not_measured["geometry"] = "there are flat fields only";
    EXPECT_THROW(lensfun_export(profile, options()), InputError);
}

}  // namespace lensproof::calibration::lensfun_test
