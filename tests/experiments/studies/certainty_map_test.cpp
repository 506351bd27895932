// Where a measurement knows the projection: hatching lies where the model extrapolates and nowhere else, and the page
// shows the drawing.
#include "experiments/studies/certainty_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiments/draw/report/report.h"

namespace lensproof::studies {
namespace {

const std::vector<Vec2d> kDiamond = {{50.0, 10.0}, {90.0, 40.0}, {50.0, 70.0}, {10.0, 40.0}};

// |x − 50| / 40 + |y − 40| / 30 ≤ 1: the same diamond by another formula.
double beyond_the_diamond(const Vec2d& p) {
    return std::abs(p.x - 50.0) / 40.0 + std::abs(p.y - 40.0) / 30.0 - 1.0;
}

double length(const std::vector<Vec2d>& piece) {
    return std::hypot(piece[1].x - piece[0].x, piece[1].y - piece[0].y);
}

// Lines at 45° that are `step` apart along x stand step / √2 from each other, so they have area / (step / √2) of length
// in an area: here 100 × 80 without the diamond's 2400. A line's ends count with half a step: 1 % of 79 lines.
TEST(CertaintyMap, HatchingFillsWhatLiesOutsideTheHull) {
    constexpr double kStep = 0.5;
    double total = 0.0;
    for (const std::vector<Vec2d>& piece : hatching_outside(kDiamond, 100.0, 80.0, kStep)) {
        total += length(piece);
        for (const double t : {0.01, 0.5, 0.99}) {
            const Vec2d p{std::lerp(piece[0].x, piece[1].x, t), std::lerp(piece[0].y, piece[1].y, t)};
            EXPECT_GT(beyond_the_diamond(p), -1e-9);
            EXPECT_TRUE(p.x >= -0.5 && p.x <= 99.5 && p.y >= -0.5 && p.y <= 79.5);
        }
    }
    EXPECT_NEAR(total * kStep / std::sqrt(2.0), 100.0 * 80.0 - 2400.0, 0.01 * 5600.0);
}

TEST(CertaintyMap, TheSenseOfTheHullDoesNotMatter) {
    const std::vector<Vec2d> reversed(kDiamond.rbegin(), kDiamond.rend());
    const auto one = hatching_outside(kDiamond, 100.0, 80.0, 3.0);
    const auto other = hatching_outside(reversed, 100.0, 80.0, 3.0);
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_NEAR(one[i][1].x, other[i][1].x, 1e-9);
    }
    EXPECT_TRUE(hatching_outside({}, 100.0, 80.0, 3.0).empty());
}

/// Three columns and two rows; the point at the lower right is outside the hull, that at the upper right not imaged.
calibration::Profile small_profile() {
    calibration::Profile profile{.name = "small", .width_px = 300, .height_px = 200};
    profile.geometry = calibration::ProfileGeometry{.model = calibration::BrownConrady{{300.0, 149.5, 99.5}}};
    profile.geometry->uncertainty = calibration::UncertaintyMap{.columns = 3,
                                                                .rows = 2,
                                                                .x_px = {0.0, 149.5, 299.0},
                                                                .y_px = {0.0, 199.0},
                                                                .near_mm = 1000.0,
                                                                .far_px = {0.01, 0.02, std::nullopt, 0.03, 0.04, 7.0},
                                                                .near_px = std::vector<std::optional<double>>(6, 0.1),
                                                                .covered = {true, true, false, true, true, false}};
    calibration::ProfileView view{.image = "view", .found = true};
    view.points = {{{}, {0.0, 0.0}, {}, true},
                   {{}, {149.5, 0.0}, {}, true},
                   {{}, {149.5, 199.0}, {}, true},
                   {{}, {0.0, 199.0}, {}, true},
                   {{}, {299.0, 199.0}, {}, false}};
    profile.views = {view};
    return profile;
}

TEST(CertaintyMap, SaysWhatItShows) {
    const calibration::Profile profile = small_profile();
    const draw::AxisRange range = certainty_range({&profile});
    EXPECT_EQ(range.low, 0.01);
    EXPECT_EQ(range.high, 0.4);  // what is extrapolated does not stretch the colours
    const CertaintyMap map = certainty_map(profile, "Small", "#0072b2", range);
    for (const char* part :
         {"0.01 px (1 σ) at the best place", "0.04 px inside the hull", "67 % of the frame", "7 px at"}) {
        EXPECT_NE(map.caption.find(part), std::string::npos) << part << ": " << map.caption;
    }
    EXPECT_NE(map.svg.find("From 4 points"), std::string::npos);  // the outlier is none of them
    EXPECT_EQ(map.svg.find("nan"), std::string::npos);
    const std::string page =
        draw::report_html({{"maps", {{{"name", "a.svg"}, {"caption", map.caption}}}}}, {{"a.svg", map.svg}});
    EXPECT_NE(page.find("src=\"data:image/svg+xml;base64,"), std::string::npos);
    EXPECT_NE(page.find(map.caption), std::string::npos);
}

}  // namespace
}  // namespace lensproof::studies
