#include "experiments/draw/heat_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "engine/base/infinity.h"
#include "engine/formats/image/image.h"
#include "experiments/draw/chart.h"
#include "tests/experiments/draw/svg_checks.h"

namespace lensproof::draw::heat_map_test {

/// RFC 4648, section 4, the other way.
std::string from_base64(const std::string& text) {
    const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned bits = 0;
    int count = 0;
    for (const char c : text) {
        const std::size_t sextet = alphabet.find(c);
        if (sextet == std::string::npos) {
            break;
        }
        bits = bits << 6 | static_cast<unsigned>(sextet);
        count += 6;
        if (count >= 8) {
            count -= 8;
            bytes += static_cast<char>(bits >> count & 0xFFu);
        }
    }
    return bytes;
}

/// The first picture of a drawing.
formats::Image first_picture(const std::string& svg, const std::string& name) {
    const std::string prefix = "data:image/png;base64,";
    const std::size_t start = svg.find(prefix) + prefix.size();
    const std::string file = ::testing::TempDir() + name + ".png";
    std::ofstream(file, std::ios::binary) << from_base64(svg.substr(start, svg.find('"', start) - start));
    return formats::read_image(file);
}

PlotChart map_chart(HeatMap map) {
    return {
        .title = "Map", .x = {.label = "x", .unit = "µm"}, .y = {.label = "y", .unit = "µm"}, .map = std::move(map)};
}

HeatMap small_map() {
    return {.columns = 3,
            .rows = 2,
            .values = {0.0, 0.5, 1.0,  // low y
                       kNaN, 0.25, 9.0},
            .x = {-3.0, 3.0},
            .y = {-2.0, 2.0},
            .range = {0.0, 1.0},
            .label = "Intensity"};
}

void expect_pixel(const formats::Image& image, int x, int y, const Vec3d& rgb) {
    // 8 bits of sRGB: half a step is at most 0.0047 in linear light, at white.
    EXPECT_NEAR(image.at(x, y, 0), rgb.x, 0.005) << x << " " << y;
    EXPECT_NEAR(image.at(x, y, 1), rgb.y, 0.005) << x << " " << y;
    EXPECT_NEAR(image.at(x, y, 2), rgb.z, 0.005) << x << " " << y;
}

TEST(HeatMap, EveryPixelHasTheColourOfItsValueAndHighYIsAtTheTop) {
    const std::string svg = chart_svg(map_chart(small_map()));
    EXPECT_TRUE(is_sound(svg));
    const formats::Image image = first_picture(svg, "map");
    ASSERT_EQ(image.width, 3);
    ASSERT_EQ(image.height, 2);
    // 0.5 of 255 shades is none of them: half a shade off.
    expect_pixel(image, 0, 1, map_colour(ColourMap::sequential, 0.0));
    expect_pixel(image, 1, 1, map_colour(ColourMap::sequential, 128.0 / 255.0));
    expect_pixel(image, 2, 1, map_colour(ColourMap::sequential, 1.0));
    expect_pixel(image, 2, 0, map_colour(ColourMap::sequential, 1.0));
    EXPECT_NEAR(image.at(0, 0, 0), image.at(0, 0, 1), 0.02);  // masked: as grey as paper
}

// As pictures have it: the lowest y, and the map's first row, at the top.
TEST(HeatMap, OnAnAxisThatRunsDownwardsTheFirstRowIsAtTheTop) {
    PlotChart chart = map_chart(small_map());
    chart.y.low = 2.0;
    chart.y.high = -2.0;
    const ChartFrame frame = chart_frame(chart, {10.0, 20.0, 300.0, 200.0});
    EXPECT_EQ(frame.to_page({-3.0, -2.0}).y, 20.0);
    EXPECT_EQ(frame.to_page({-3.0, 2.0}).y, 220.0);
    const std::string svg = chart_svg(chart);
    EXPECT_TRUE(is_sound(svg));
    const formats::Image image = first_picture(svg, "downwards");
    expect_pixel(image, 0, 0, map_colour(ColourMap::sequential, 0.0));
    expect_pixel(image, 2, 1, map_colour(ColourMap::sequential, 1.0));
    expect_pixel(image, 1, 1, map_colour(ColourMap::sequential, 64.0 / 255.0));
}

TEST(HeatMap, LogarithmicColoursAreEvenInDecades) {
    HeatMap map = small_map();
    map.scale = AxisScale::logarithmic;
    map.range = {1e-4, 1.0};
    map.values = {1e-4, 1e-2, 1.0, 0.0, -1.0, 1e-9};
    const formats::Image image = first_picture(chart_svg(map_chart(map)), "log");
    expect_pixel(image, 1, 1, map_colour(ColourMap::sequential, 128.0 / 255.0));
    for (int x = 0; x < 3; ++x) {
        expect_pixel(image, x, 0, map_colour(ColourMap::sequential, 0.0));
    }
}

TEST(HeatMap, TheMapFillsItsPlaceOnTheAxes) {
    const PlotChart chart = map_chart(small_map());
    const ChartFrame frame = chart_frame(chart, {10.0, 20.0, 300.0, 200.0});
    EXPECT_EQ(frame.to_page({-3.0, 2.0}).x, 10.0);
    EXPECT_EQ(frame.to_page({-3.0, 2.0}).y, 20.0);
    EXPECT_EQ(frame.to_page({3.0, -2.0}).x, 310.0);
}

TEST(HeatMap, AxesMayReachBeyondTheMapButNotCutIt) {
    PlotChart chart = map_chart(small_map());
    chart.x.low = -6.0;
    chart.x.high = 1.0;
    const ChartFrame frame = chart_frame(chart, {0.0, 0.0, 300.0, 200.0});
    EXPECT_EQ(frame.x.low, -6.0);
    EXPECT_EQ(frame.x.high, 3.0);
}

TEST(HeatMap, AnyRangeIsDrawn) {
    const double infinity = kInfinity;
    for (const AxisScale scale : {AxisScale::linear, AxisScale::logarithmic}) {
        for (const AxisRange range : {AxisRange{0.0, 0.0}, AxisRange{1.0, -1.0}, AxisRange{kNaN, 1.0},
                                      AxisRange{0.0, 1e-300}, AxisRange{-infinity, infinity}, AxisRange{5.0, 5.0}}) {
            HeatMap map = small_map();
            map.scale = scale;
            map.range = range;
            EXPECT_TRUE(is_sound(chart_svg(map_chart(map)))) << range.low << " " << range.high;
        }
    }
    HeatMap masked = small_map();
    masked.values.assign(6, kNaN);
    EXPECT_NE(chart_svg(map_chart(masked)).find("no data"), std::string::npos);
    EXPECT_EQ(symmetric_range(masked.values, 0.5).high, 0.5);
    EXPECT_EQ(symmetric_range({-3.0, kNaN, 2.0}, 0.5).low, -3.0);
}

/// CIE 1976 lightness, 0 to 100, of linear sRGB.
double lightness(const Vec3d& rgb) {
    const double y = 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z;
    return y > 216.0 / 24389.0 ? 116.0 * std::cbrt(y) - 16.0 : y * 24389.0 / 27.0;
}

// A second measure of lightness, older than the one the maps are made with: it rises all along a sequential map, with
// steps that are alike, and falls evenly to both sides of a diverging one's middle.
TEST(ColourMap, EqualStepsLookEqual) {
    double least = 100.0;
    double most = 0.0;
    for (int i = 0; i < 16; ++i) {
        const double step = lightness(map_colour(ColourMap::sequential, (i + 1) / 16.0)) -
                            lightness(map_colour(ColourMap::sequential, i / 16.0));
        least = std::min(least, step);
        most = std::max(most, step);
    }
    EXPECT_GT(least, 3.0);
    EXPECT_LT(most, 2.0 * least);
    for (int i = 0; i < 8; ++i) {
        const double below = lightness(map_colour(ColourMap::diverging, 0.5 - i / 16.0));
        const double above = lightness(map_colour(ColourMap::diverging, 0.5 + i / 16.0));
        EXPECT_NEAR(below, above, 8.0);
        EXPECT_LT(lightness(map_colour(ColourMap::diverging, 0.5 + (i + 1) / 16.0)), above);
    }
    for (const ColourMap map : {ColourMap::sequential, ColourMap::diverging}) {
        for (int i = 0; i <= 100; ++i) {
            const Vec3d rgb = map_colour(map, i / 100.0);
            EXPECT_GE(std::min({rgb.x, rgb.y, rgb.z}), 0.0);
            EXPECT_LE(std::max({rgb.x, rgb.y, rgb.z}), 1.0);
        }
    }
}

}  // namespace lensproof::draw::heat_map_test
