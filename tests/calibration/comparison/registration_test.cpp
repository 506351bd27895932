// tests/calibration/comparison/registration_test.cpp — pictures of scenes in closed form, moved by what is known.
#include "calibration/comparison/registration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "calibration/comparison/spline_surface.h"
#include "engine/base/angle.h"
#include "tests/calibration/comparison/pictures.h"

namespace lensproof::calibration::registration_test {
namespace {

using comparison_test::discs;
using comparison_test::kHere;

constexpr int kWidth = 160;
constexpr int kHeight = 120;

std::map<std::string, Estimate> parameters(const Registration& registration) {
    std::map<std::string, Estimate> found;
    for (const auto& [name, estimate] : registration.parameters) {
        found[name] = estimate;
    }
    return found;
}

// Of a wave of 8 px a period the spline passes between the pixels within 0.2 % of the amplitude; at the pixels it is
// exact.
TEST(SplineSurface, PassesBetweenPixels) {
    const auto wave = [](double x, double y) {
        return std::sin(2.0 * std::numbers::pi * x / 8.0) * std::cos(2.0 * std::numbers::pi * y / 11.0);
    };
    formats::Image image = formats::make_image(64, 48, {"Y"});
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            image.at(x, y, 0) = static_cast<float>(wave(x, y));
        }
    }
    const SplineSurface surface(image, 0, 1);
    for (int y = 10; y < 38; ++y) {
        for (int x = 10; x < 54; ++x) {
            EXPECT_NEAR(surface.at({1.0 * x, 1.0 * y}), wave(x, y), 1e-6);
            EXPECT_NEAR(surface.at({x + 0.4, y + 0.7}), wave(x + 0.4, y + 0.7), 2e-3);
        }
    }
    EXPECT_NEAR(surface.at({63.0, 47.0}), wave(63, 47), 1e-6) << "the farthest corner is covered";
    EXPECT_FALSE(surface.covers({63.01, 3.0}));
}

// Noise-free and smooth: what is left is the spline, and that the light by which each picture is compressed is its own.
TEST(Registration, FindsAShiftToThousandthsOfAPixel) {
    const formats::Image a = discs(kWidth, kHeight, kHere);
    for (const Vec2d shift : {Vec2d{0.37, -0.81}, Vec2d{-2.5, 0.25}, Vec2d{23.125, 11.6}}) {
        const formats::Image b = discs(kWidth, kHeight, [&](const Vec2d& p) { return p - shift; });
        const Registration found = register_pictures(a, b, std::nullopt, 1);
        ASSERT_EQ(found.model, WarpModel::translation) << found.reason;
        EXPECT_NEAR(parameters(found)["shift_x_px"].value, shift.x, 2e-3);
        EXPECT_NEAR(parameters(found)["shift_y_px"].value, shift.y, 2e-3);
        EXPECT_LT(found.residual_px, 0.01);
    }
}

// With noise of 0.5 % of full scale in both, 0.01 px and less, and the stated errors hold: of 24 numbers' squared
// deviations in standard errors the mean is 1 ± 0.29; a range of four of those. (Both pictures' noise is new each
// time.)
TEST(Registration, StatesItsErrors) {
    double squares = 0.0;
    double misses = 0.0;
    for (unsigned trial = 0; trial < 12; ++trial) {
        const Vec2d shift{0.1 + 0.13 * trial, 0.9 - 0.21 * trial};
        const formats::Image a = discs(kWidth, kHeight, kHere, 0.005, 100 + trial);
        const formats::Image b = discs(
            kWidth, kHeight, [&](const Vec2d& p) { return p - shift; }, 0.005, 200 + trial);
        const Registration found = register_pictures(a, b, WarpModel::translation, 1);
        for (const auto& [name, truth] : {std::pair{"shift_x_px", shift.x}, std::pair{"shift_y_px", shift.y}}) {
            const Estimate estimate = parameters(found)[name];
            squares += std::pow((estimate.value - truth) / estimate.standard_error, 2.0) / 24.0;
            misses += std::pow(estimate.value - truth, 2.0) / 24.0;
        }
    }
    EXPECT_LT(std::sqrt(misses), 0.01);
    EXPECT_GT(squares, 0.2);
    EXPECT_LT(squares, 2.2);
}

TEST(Registration, FindsTurnAndScale) {
    const double turn = radians(17.0);
    const double scale = 0.93;
    const Vec2d shift{6.0, -4.0};
    const Vec2d middle{0.5 * (kWidth - 1), 0.5 * (kHeight - 1)};
    const formats::Image a = discs(kWidth, kHeight, kHere, 0.002, 1);
    const formats::Image b = discs(
        kWidth, kHeight,
        [&](const Vec2d& p) {
            const Vec2d q = p - middle - shift;
            return middle +
                   Vec2d{std::cos(turn) * q.x + std::sin(turn) * q.y, -std::sin(turn) * q.x + std::cos(turn) * q.y} /
                       scale;
        },
        0.002, 2);
    const Registration found = register_pictures(a, b, std::nullopt, 1);
    ASSERT_EQ(found.model, WarpModel::similarity) << found.reason;
    const auto estimates = parameters(found);
    const std::map<std::string, double> truth{
        {"shift_x_px", shift.x}, {"shift_y_px", shift.y}, {"scale", scale}, {"rotation_deg", 17.0}};
    for (const auto& [name, value] : truth) {
        // Four standard errors, and a thousandth of a pixel at the frame's corner for the spline.
        EXPECT_NEAR(estimates.at(name).value, value, 4.0 * estimates.at(name).standard_error + 1e-3) << name;
    }
}

TEST(Registration, FindsAHomography) {
    const FrameScale frame(kWidth, kHeight);
    const Warp truth = small_warp({0.02, -0.01, 0.01, -0.02, 0.015, 0.008, 0.03, -0.02});
    const formats::Image b = discs(kWidth, kHeight, kHere);
    const formats::Image a =
        discs(kWidth, kHeight, [&](const Vec2d& p) { return frame.px(truth(frame.unit(p.x, p.y))); });
    const Registration found = register_pictures(a, b, std::nullopt, 1);
    ASSERT_EQ(found.model, WarpModel::homography) << found.reason;
    for (const Vec2d p : {Vec2d{5.0, 5.0}, Vec2d{150.0, 10.0}, Vec2d{80.0, 60.0}, Vec2d{20.0, 110.0}}) {
        const Vec2d expected = frame.px(truth(frame.unit(p.x, p.y)));
        const Vec2d reached = frame.px(found.warp(frame.unit(p.x, p.y)));
        EXPECT_NEAR(reached.x, expected.x, 0.01);
        EXPECT_NEAR(reached.y, expected.y, 0.01);
    }
}

TEST(Registration, LeavesPicturesThatLieOverEachOther) {
    const Registration found = register_pictures(discs(kWidth, kHeight, kHere, 0.01, 5),
                                                 discs(kWidth, kHeight, kHere, 0.01, 6), std::nullopt, 1);
    EXPECT_EQ(found.model, WarpModel::none);
    EXPECT_EQ(found.likeness, Likeness::alike);
    EXPECT_TRUE(found.parameters.empty());
}

TEST(Registration, KnowsWhatHasNothingInCommon) {
    const formats::Image a = discs(kWidth, kHeight, kHere);
    const formats::Image stripes = comparison_test::made(
        kWidth, kHeight, [](int x, int y, int /*c*/) { return 0.5 + 0.4 * std::sin(0.5 * x + 0.02 * y * y); });
    EXPECT_EQ(register_pictures(a, stripes, std::nullopt, 1).likeness, Likeness::unlike);
    EXPECT_NE(register_pictures(a, formats::make_image(kWidth, kHeight, {"R", "G", "B"}), std::nullopt, 1).likeness,
              Likeness::alike)
        << "black";
}

// A picture moved by d and registered back is the picture: within the spline's error of it.
TEST(WarpedPicture, IsWhatTheOtherShows) {
    const formats::Image a = discs(kWidth, kHeight, kHere);
    const formats::Image b = discs(kWidth, kHeight, [](const Vec2d& p) { return p - Vec2d{3.3, -1.6}; });
    const Registration found = register_pictures(a, b, std::nullopt, 1);
    const WarpedPicture back = warped(b, found, 1);
    double largest = 0.0;
    for (int y = 5; y < kHeight - 5; ++y) {
        for (int x = 5; x < kWidth - 5; ++x) {
            for (int c = 0; c < 3; ++c) {
                largest = std::max(largest, static_cast<double>(std::abs(a.at(x, y, c) - back.image.at(x, y, c))));
            }
        }
    }
    EXPECT_LT(largest, 0.003);
    EXPECT_EQ(back.overlap[60 * kWidth + kWidth - 2], 0) << "what the other does not show is not in common";
    EXPECT_EQ(back.overlap[60 * kWidth + 80], 255);
}

}  // namespace
}  // namespace lensproof::calibration::registration_test
