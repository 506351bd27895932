#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "calibration/twins/pixel_account.h"
#include "calibration/twins/point_account.h"
#include "tests/calibration/synthetic.h"

namespace lensproof::calibration::accounts_test {
namespace {

constexpr int kWidth = 600;
constexpr int kHeight = 400;
constexpr int kColumns = 9;
constexpr int kRows = 6;

struct Planted {
    double lens_px = 0.0;   // at the corner, along the radius, by the third power of the height
    double chart_mm = 0.0;  // standard deviation of a point along x and y
    double noise_px = 0.0;
};

/// Points of a chart in eight photos, in which it stands elsewhere and otherwise each time, with what is planted.
std::vector<TwinPoint> planted_points(const Planted& planted) {
    synthetic::Noise noise(3);
    std::vector<Vec2d> misprint;
    misprint.reserve(std::size_t{kColumns} * kRows);
    for (int i = 0; i < kColumns * kRows; ++i) {
        misprint.push_back({planted.chart_mm * noise(), planted.chart_mm * noise()});
    }
    std::vector<TwinPoint> points;
    for (int view = 0; view < 8; ++view) {
        const double angle = 0.4 * view;
        const double scale = 0.8 + 0.1 * (view % 3);  // px/mm
        const Vec2d middle{299.5 + 60.0 * std::cos(2.1 * view), 199.5 + 40.0 * std::sin(1.7 * view)};
        const Vec2d along_x{scale * std::cos(angle), scale * std::sin(angle)};
        const Vec2d along_y{-along_x.y, along_x.x};
        for (int i = 0; i < kColumns * kRows; ++i) {
            const int row = i / kColumns;
            const Vec2d mm{40.0 * (i % kColumns - 4.0), 40.0 * (row - 2.5)};
            const Vec2d at = middle + mm.x * along_x + mm.y * along_y;
            const Vec2d u = (1.0 / 360.6) * (at - Vec2d{299.5, 199.5});
            const Vec2d& misprinted = misprint[static_cast<std::size_t>(i)];
            // What the chart's other place would do is no one's: 0.3 px and a little turn.
            const Vec2d elsewhere{0.3 + 0.2 * u.y, -0.2 - 0.2 * u.x};
            Vec2d by = elsewhere + planted.lens_px * dot(u, u) * u + misprinted.x * along_x + misprinted.y * along_y;
            by = by + Vec2d{planted.noise_px * noise(), planted.noise_px * noise()};
            points.push_back({.view = view,
                              .feature = i,
                              .photo_px = at + by,
                              .twin_px = at,
                              .standard_error_px = Vec2d{planted.noise_px, planted.noise_px},
                              .by_chart_x_px = along_x,
                              .by_chart_y_px = along_y});
        }
    }
    return points;
}

TEST(PointAccount, NoiseAloneIsNoLensAndNoChart) {
    const PointAccount account = account_of_points(planted_points({.noise_px = 0.05}), kWidth, kHeight);
    EXPECT_EQ(account.points, 8 * kColumns * kRows);
    EXPECT_EQ(account.views, 8);
    EXPECT_GT(account.displaced_px, 0.2);  // the charts' places
    // Within three of their errors of nothing.
    EXPECT_LT(account.lens.rms_px, 3.0 * account.lens.standard_error_px);
    EXPECT_LT(account.chart.rms_px, 3.0 * account.chart.standard_error_px);
    // 864 coordinates less some 200 unknowns know it to 2.7 %; four of that.
    EXPECT_NEAR(account.rest_px, 0.05, 0.006);
    EXPECT_NEAR(account.expected_px, 0.05, 1e-12);
}

TEST(PointAccount, WhatIsPlantedIsFoundWhereItBelongs) {
    const PointAccount lens = account_of_points(planted_points({.lens_px = 3.0, .noise_px = 0.02}), kWidth, kHeight);
    EXPECT_GT(lens.lens.significance, 100.0);
    EXPECT_LT(lens.chart.rms_px, 0.1 * lens.lens.rms_px);
    EXPECT_NEAR(lens.rest_px, 0.02, 0.003);
    // Of a third power, what the charts' places cannot take: less than all, and outwards at the rim.
    EXPECT_GT(lens.lens.rms_px, 0.02);
    EXPECT_LT(lens.lens.rms_px, 3.0);
    ASSERT_FALSE(lens.radial_px.value.empty());
    EXPECT_GT(lens.radial_px.value.back(), 0.1);

    const PointAccount chart = account_of_points(planted_points({.chart_mm = 0.2, .noise_px = 0.02}), kWidth, kHeight);
    EXPECT_GT(chart.chart.significance, 20.0);
    // 0.9 px/mm of 0.2 mm, less what eight views' places and the lens's polynomial can take of it.
    EXPECT_GT(chart.chart.rms_px, 0.1);
    EXPECT_LT(chart.chart.rms_px, 0.19);
    EXPECT_LT(chart.lens.rms_px, 0.5 * chart.chart.rms_px);
    EXPECT_NEAR(chart.rest_px, 0.02, 0.003);
}

TEST(PointAccount, ErrorsThatAreNotKnownDoNotCountAsNone) {
    std::vector<TwinPoint> points = planted_points({.noise_px = 0.05});
    for (std::size_t i = 0; i < points.size(); i += 2) {
        points[i].standard_error_px.reset();
    }
    EXPECT_NEAR(account_of_points(points, kWidth, kHeight).expected_px, 0.05, 1e-12);
    for (TwinPoint& point : points) {
        point.standard_error_px.reset();
    }
    EXPECT_TRUE(std::isnan(account_of_points(points, kWidth, kHeight).expected_px));
}

TEST(PointAccount, TwoPhotosCannotTellTheChartFromTheLens) {
    std::vector<TwinPoint> points = planted_points({.chart_mm = 0.2, .noise_px = 0.02});
    std::erase_if(points, [](const TwinPoint& point) { return point.view > 1; });
    const PointAccount account = account_of_points(points, kWidth, kHeight);
    EXPECT_TRUE(std::isnan(account.chart.rms_px));
    EXPECT_FALSE(std::isnan(account.lens.rms_px));
}

TEST(PointAccount, StepsOnTheChartAreThoseOfAnAffinePicture) {
    std::vector<Vec2d> mm;
    std::vector<Vec2d> px;
    for (int i = 0; i < 20; ++i) {
        const int row = i / 5;
        mm.push_back({10.0 * (i % 5), 10.0 * row});
        px.push_back({3.0 + 2.0 * mm.back().x - 0.5 * mm.back().y, 1.0 + 0.25 * mm.back().x + 1.5 * mm.back().y});
    }
    const auto [along_x, along_y] = steps_on_chart(mm, px, {20.0, 10.0});
    EXPECT_NEAR(along_x.x, 2.0, 1e-12);
    EXPECT_NEAR(along_x.y, 0.25, 1e-12);
    EXPECT_NEAR(along_y.x, -0.5, 1e-12);
    EXPECT_NEAR(along_y.y, 1.5, 1e-12);
}

/// Squares of 24 px with edges that are `softness` wide (the logistic function's), moved by `x` px.
formats::Image squares(double x_px, double softness, const std::function<double(double, double)>& light) {
    formats::Image image = formats::make_image(240, 180, {"Y"});
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const double pattern =
                std::sin(std::numbers::pi * (x - x_px) / 24.0) * std::sin(std::numbers::pi * y / 24.0);
            const double white = 1.0 / (1.0 + std::exp(-pattern / softness));
            image.at(x, y, 0) = static_cast<float>((0.1 + 0.5 * white) * light(x, y));
        }
    }
    return image;
}

double even(double, double) {
    return 1.0;
}

/// The corners of the squares, where photo and twin show them.
std::vector<TwinPoint> corners(double photo_x_px) {
    std::vector<TwinPoint> points;
    for (int i = 0; i < 8 * 6; ++i) {
        const int row = i / 8;
        const Vec2d at{24.0 * (1.0 + i % 8), 24.0 * (1.0 + row)};
        points.push_back({.view = 0,
                          .feature = i,
                          .photo_px = {at.x + photo_x_px, at.y},
                          .twin_px = at,
                          .standard_error_px = {},
                          .by_chart_x_px = {},
                          .by_chart_y_px = {}});
    }
    return points;
}

TEST(PixelAccount, LaysWhatDiffersToItsCause) {
    const formats::Image twin = squares(0.0, 0.15, even);
    const auto account = [&](const formats::Image& photo, double moved_px) {
        return account_of_pixels({.photo = photo, .twin = twin, .contrast = 0.5}, corners(moved_px));
    };
    // The same but for exposure.
    const PixelAccount same = account(squares(0.0, 0.15, [](double, double) { return 0.7; }), 0.0);
    EXPECT_LT(same.as_rendered, 1e-6);

    const PixelAccount lit = account(squares(0.0, 0.15, [](double x, double) { return 1.0 + 0.001 * x; }), 0.0);
    EXPECT_GT(lit.light, 0.02);
    EXPECT_LT(std::hypot(lit.place, lit.sharpness, lit.unexplained), 0.02 * lit.light);

    const PixelAccount moved = account(squares(0.8, 0.15, even), 0.8);
    EXPECT_GT(moved.place, 0.02);
    // A spline between the pixels of edges that are a few of them wide.
    EXPECT_LT(std::hypot(moved.sharpness, moved.unexplained), 0.1 * moved.place);

    const PixelAccount softer = account(squares(0.0, 0.25, even), 0.0);
    EXPECT_GT(softer.sharpness, 0.01);
    EXPECT_LT(softer.place, 1e-9);
    EXPECT_LT(softer.unexplained, softer.sharpness);
}

TEST(PixelAccount, NoiseThatIsStatedIsExplained) {
    synthetic::Noise noise(5);
    formats::Image photo = squares(0.0, 0.15, even);
    for (float& value : photo.pixels) {
        value += static_cast<float>(0.01 * noise());
    }
    const formats::Image twin = squares(0.0, 0.15, even);
    const PixelAccount account =
        account_of_pixels({.photo = photo, .twin = twin, .contrast = 0.5, .photo_noise = 0.01}, corners(0.0));
    EXPECT_NEAR(account.as_rendered, 0.02, 0.001);  // of 15,000 pixels: 0.6 % of it
    // 1 % of its squares are left by chance.
    EXPECT_LT(account.unexplained, 0.1 * 0.02 + 0.002);
}

TEST(PixelAccount, TheTwinIsShownInThePhotosExposure) {
    const formats::Image twin = squares(0.0, 0.15, even);
    formats::Image photo = twin;
    for (float& value : photo.pixels) {
        value = 0.05F + 0.5F * value;
    }
    const formats::Image lit = in_light_of(twin, photo, corners(0.0));
    for (std::size_t i = 0; i < lit.pixels.size(); ++i) {
        ASSERT_NEAR(lit.pixels[i], photo.pixels[i], 1e-5);
    }
}

}  // namespace
}  // namespace lensproof::calibration::accounts_test
