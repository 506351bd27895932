// The table of quantities: keys are those that profiles have always had.
#include "calibration/profile/quantity.h"

#include <gtest/gtest.h>

namespace lensproof::calibration::quantity_test {

// A channel's name stands within the key, and the longer of two keys that fit is meant.
TEST(CalibrationQuantity, AKeySaysItsQuantityAndItsChannel) {
    const auto read = [](const char* key) {
        const auto found = quantity_of(key);
        return found ? std::string(found->quantity.key.pattern) + " of " + found->channel : "nothing";
    };
    EXPECT_EQ(read("distortion_percent"), "distortion_percent of ");
    EXPECT_EQ(read("vignetting_G"), "vignetting_{} of G");
    EXPECT_EQ(read("vignetting_G_ev"), "vignetting_{}_ev of G");
    EXPECT_EQ(read("chromatic_shift_450nm_px"), "chromatic_shift_{}_px of 450nm");
    EXPECT_EQ(read("chromatic_shift_tangential_R_px"), "chromatic_shift_tangential_{}_px of R");
    EXPECT_EQ(read("mtf50_tangential_over_sagittal_Y"), "mtf50_tangential_over_sagittal_{} of Y");
    EXPECT_EQ(read("mtf50_sagittal_Y_cycles_per_mm"), "mtf50_sagittal_{}_cycles_per_mm of Y");
    EXPECT_EQ(read("chromatic_shift__px"), "nothing");
    EXPECT_EQ(read("sharpness"), "nothing");
}

TEST(CalibrationQuantity, EveryComparedCurveHasATitleAndAUnit) {
    const std::vector<std::string> curves = compared_curves();
    EXPECT_EQ(curves.size(), 14U);
    for (const std::string& curve : curves) {
        const auto found = quantity_of(curve);
        ASSERT_TRUE(found) << curve;
        EXPECT_EQ(found->quantity.key(found->channel), curve);
        EXPECT_EQ(found->quantity.title(found->channel).find('{'), std::string::npos);
        EXPECT_TRUE(curve.ends_with(found->quantity.unit.suffix)) << curve;
    }
}

}  // namespace lensproof::calibration::quantity_test
