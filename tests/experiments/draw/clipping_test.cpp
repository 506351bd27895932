// What lies inside an outline and outside the hole in it is hatched, and nothing else.
#include "experiments/draw/clipping.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lensproof::draw::clipping_test {

const std::vector<SvgPoint> kFrame = {{0.0, 0.0}, {100.0, 0.0}, {100.0, 80.0}, {0.0, 80.0}};
const std::vector<SvgPoint> kDiamond = {{50.0, 10.0}, {90.0, 40.0}, {50.0, 70.0}, {10.0, 40.0}};

// |x − 50| / 40 + |y − 40| / 30 ≤ 1: the same diamond by another formula.
double beyond_the_diamond(const SvgPoint& p) {
    return std::abs(p.x - 50.0) / 40.0 + std::abs(p.y - 40.0) / 30.0 - 1.0;
}

double length(const std::vector<SvgPoint>& piece) {
    return std::hypot(piece[1].x - piece[0].x, piece[1].y - piece[0].y);
}

// Lines at 45° that are `step` apart along x stand step / √2 from each other, so they have area / (step / √2) of length
// in an area: here 100 × 80 without the diamond's 2400. A line's ends count with half a step: 1 % of 79 lines.
TEST(Hatching, FillsWhatLiesOutsideAHole) {
    constexpr double kStep = 0.5;
    double total = 0.0;
    for (const std::vector<SvgPoint>& piece : hatching({kFrame, kDiamond}, kStep)) {
        total += length(piece);
        for (const double t : {0.01, 0.5, 0.99}) {
            const SvgPoint p{std::lerp(piece[0].x, piece[1].x, t), std::lerp(piece[0].y, piece[1].y, t)};
            EXPECT_GT(beyond_the_diamond(p), -1e-9);
            EXPECT_TRUE(p.x >= -1e-9 && p.x <= 100.0 + 1e-9 && p.y >= -1e-9 && p.y <= 80.0 + 1e-9);
        }
    }
    EXPECT_NEAR(total * kStep / std::sqrt(2.0), 100.0 * 80.0 - 2400.0, 0.01 * 5600.0);
}

TEST(Hatching, TheSenseOfAHoleDoesNotMatter) {
    const std::vector<SvgPoint> reversed(kDiamond.rbegin(), kDiamond.rend());
    const auto one = hatching({kFrame, kDiamond}, 3.0);
    const auto other = hatching({kFrame, reversed}, 3.0);
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_NEAR(one[i][1].x, other[i][1].x, 1e-9);
    }
    EXPECT_TRUE(hatching({}, 3.0).empty());
}

}  // namespace lensproof::draw::clipping_test
