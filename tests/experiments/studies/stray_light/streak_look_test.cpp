// tests/experiments/studies/stray_light/streak_look_test.cpp — a painted star is found as it was painted.
#include "experiments/studies/stray_light/streak_look.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/angle.h"

namespace lensproof::studies::streak_look_test {

constexpr render::Sensor kSensor{.width = 600, .height = 400, .pixel_pitch_mm = 0.06};
constexpr Vec2d kLamp{-1.7, 1.1};

/// Streaks of 3° about `streaks` directions from `first_deg` on, that fall with the distance's power, on a haze that
/// does not.
formats::Image star(int streaks, double first_deg, double power, double haze) {
    formats::Image image = formats::make_image(kSensor.width, kSensor.height, {"Y"});
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const Vec2d off = kSensor.position(x, y) - kLamp;
            const double radius = std::max(0.1, std::hypot(off.x, off.y));
            const double step = 360.0 / streaks;
            const double angle = std::atan2(off.y, off.x) / kDegree - first_deg;
            const double aside = (angle - step * std::round(angle / step)) / 3.0;
            image.at(x, y, 0) = static_cast<float>(std::pow(radius, power) * std::exp(-0.5 * aside * aside) + haze);
        }
    }
    return image;
}

formats::Image lamp() {
    formats::Image image = formats::make_image(kSensor.width, kSensor.height, {"Y"});
    const Vec2d at = kSensor.pixel(kLamp);
    image.at(static_cast<int>(std::lround(at.x)), static_cast<int>(std::lround(at.y)), 0) = 1.0F;
    return image;
}

// The lamp's own pixel is half a pixel off at most, 0.03 mm, which turns a streak at 1.4 mm by 1.2°, one way on one
// side and the other way on the other.
TEST(StreakLook, FindsDirectionAndFallOfAStar) {
    struct Case {
        int blades;
        int streaks;
        double power;
        double haze;
    };
    for (const Case& one :
         {Case{6, 6, -3.0, 0.0}, Case{7, 14, -3.0, 0.0}, Case{5, 10, -2.5, 0.01}, Case{8, 8, -3.0, 0.01}}) {
        const optics::PolygonStop stop{.blades = one.blades, .rotation_deg = 8.0};
        const double normal = 8.0 + 180.0 / one.blades;
        const StreakLook look =
            streak_look(star(one.streaks, normal + 1.5, one.power, one.haze), lamp(), kSensor, stop);
        EXPECT_NEAR(look.offset_deg, 1.5, 0.1) << one.blades;
        EXPECT_NEAR(look.slope, one.power, 0.05) << one.blades;
        EXPECT_LT(look.offset_error_deg, 0.1);
    }
}

}  // namespace lensproof::studies::streak_look_test
