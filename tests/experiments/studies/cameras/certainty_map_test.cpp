// Where a measurement knows the projection, in words and as a drawing that the page shows.
#include <gtest/gtest.h>

#include "experiments/draw/report/report.h"
#include "experiments/studies/cameras/measured_camera.h"
#include "tests/complaint.h"

namespace lensproof::studies::certainty_map_test {

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
    const findings::Map map = certainty_map(profile, "Small");
    EXPECT_EQ(map.subject, "small");
    const draw::AxisRange range = draw::common_range({&map.frame});
    EXPECT_EQ(range.low, 0.01);
    EXPECT_EQ(range.high, 0.4);  // what is extrapolated does not stretch the colours
    const std::string svg = draw::frame_map_svg(map.frame, range, "#0072b2");
    for (const char* part : {"0.01 px (1 σ) at the best place", "0.04 px inside the hull", "67 % of the frame",
                             "7 px at", "Noise alone"}) {
        EXPECT_TRUE(says(map.caption, part));
    }
    calibration::Profile beside_rivals = profile;
    beside_rivals.geometry->uncertainty->models_px = std::vector<std::optional<double>>(6, 0.0);
    beside_rivals.geometry->uncertainty->far_px.back() = 1357.0;
    EXPECT_TRUE(says(certainty_map(beside_rivals, "Small").caption, "1357 px at the worst place"));
    EXPECT_TRUE(says(certainty_map(beside_rivals, "Small").caption, "how far models that predict the pictures"));
    EXPECT_TRUE(says(svg, "From 4 points"));  // the outlier is none of them
    EXPECT_FALSE(says(svg, "nan"));
    const std::string page =
        draw::report_html({{"maps", {{{"name", "a.svg"}, {"caption", map.caption}}}}}, {{"a.svg", svg}});
    EXPECT_TRUE(says(page, "src=\"data:image/svg+xml;base64,"));
    EXPECT_TRUE(says(page, map.caption));
}

}  // namespace lensproof::studies::certainty_map_test
