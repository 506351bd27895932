#include "engine/optics/glass.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/spectral/wavelengths.h"

namespace lensproof {
namespace {

// A catalogue's n_d and V_d are rounded to 5 digits and 2: formulas typed in right reproduce them to 1e-5 and 0.01.
TEST(Glass, FormulasReproduceTheStatedIndexAndAbbeNumber) {
    const std::vector<Glass> glasses = shipped_glasses();
    ASSERT_GE(glasses.size(), 13U);
    for (const Glass& glass : glasses) {
        EXPECT_NEAR(refractive_index(glass.formula, kLineD), glass.stated_n_d, 1e-5) << glass.name;
        EXPECT_NEAR(abbe_number(glass.formula), glass.stated_V_d, 0.01) << glass.name;
        EXPECT_TRUE(covers(glass, 400.0) && covers(glass, 700.0)) << glass.name;
    }
}

// N-BK7's data sheet (SCHOTT, 2017) lists indices of the same melt at other lines.
TEST(Glass, Bk7MatchesItsDataSheetAwayFromD) {
    const Glass bk7 = find_glass(shipped_glasses(), "bk7").value();
    EXPECT_NEAR(refractive_index(bk7.formula, kLineG), 1.52668, 1e-5);
    EXPECT_NEAR(refractive_index(bk7.formula, kLineF), 1.52238, 1e-5);
    EXPECT_NEAR(refractive_index(bk7.formula, kLineC), 1.51432, 1e-5);
    EXPECT_NEAR(refractive_index(bk7.formula, 365.0146), 1.53627, 1e-5);
}

TEST(Glass, NamesAreNotGuessed) {
    EXPECT_TRUE(find_glass(shipped_glasses(), "LAK9"));
    EXPECT_FALSE(find_glass(shipped_glasses(), "N-LAK9"));
    EXPECT_FALSE(find_glass(shipped_glasses(), ""));
}

// The model for a glass known by n_d and V_d alone meets both exactly, by construction.
TEST(Glass, NormalLineModelHasTheStatedIndexAndAbbeNumber) {
    for (const auto& [n_d, V_d] : {std::pair{1.5168, 64.17}, std::pair{1.80518, 25.43}, std::pair{1.691, 54.7}}) {
        const DispersionFormula model = buchdahl_normal_line(n_d, V_d);
        EXPECT_NEAR(refractive_index(model, kLineD), n_d, 1e-15);
        EXPECT_NEAR(abbe_number(model), V_d, 1e-11);
    }
}

// How far the model is from the glasses that ship, over 400 to 700 nm. Its worst is SF6's blue end, 7.8e-4; Cauchy's
// formula through the same n_d and V_d is more than twice as far off there.
TEST(Glass, NormalLineModelStaysNearRealGlasses) {
    double worst = 0.0;
    double worst_cauchy = 0.0;
    for (const Glass& glass : shipped_glasses()) {
        const double n_d = refractive_index(glass.formula, kLineD);
        const double V_d = abbe_number(glass.formula);
        const DispersionFormula model = buchdahl_normal_line(n_d, V_d);
        const double cauchy_b = (n_d - 1.0) / V_d / (1.0 / (kLineF * kLineF) - 1.0 / (kLineC * kLineC));
        for (double nm = 400.0; nm <= 700.0; nm += 10.0) {
            const double exact = refractive_index(glass.formula, nm);
            const double cauchy = n_d + cauchy_b * (1.0 / (nm * nm) - 1.0 / (kLineD * kLineD));
            worst = std::max(worst, std::abs(refractive_index(model, nm) - exact));
            worst_cauchy = std::max(worst_cauchy, std::abs(cauchy - exact));
        }
    }
    EXPECT_LT(worst, 8e-4);
    EXPECT_GT(worst_cauchy, 2.0 * worst);
}

}  // namespace
}  // namespace lensproof
