#include "engine/base/power_law.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lensproof::power_law_test {

TEST(PowerLaw, IsThatOfItsPoints) {
    std::vector<Vec2d> points;
    for (const double x : {0.5, 1.0, 3.0, 7.0}) {
        points.push_back({x, 4.0 * std::pow(x, -2.5)});
    }
    EXPECT_NEAR(power_law(points).exponent, -2.5, 1e-12);
    EXPECT_NEAR(power_law(points).standard_error, 0.0, 1e-7);
}

// At x = e⁻¹, 1, e the logarithms 0, 1, 0 have no slope and lie (1/3, −2/3, 1/3) off their mean: √(2/3 / (2 · 1)).
TEST(PowerLaw, StatesItsError) {
    const double e = std::exp(1.0);
    const PowerLaw law = power_law({{1.0 / e, 1.0}, {1.0, e}, {e, 1.0}});
    EXPECT_NEAR(law.exponent, 0.0, 1e-12);
    EXPECT_NEAR(law.standard_error, std::sqrt(1.0 / 3.0), 1e-12);
}

}  // namespace lensproof::power_law_test
