#include "experiments/draw/chart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "experiments/draw/clipping.h"
#include "experiments/draw/palette.h"
#include "tests/experiments/draw/svg_checks.h"

namespace lensproof::draw::chart_test {

PlotChart line_chart(std::vector<Vec2d> points) {
    return {.title = "A line",
            .x = {.label = "x", .unit = "mm"},
            .y = {.label = "y"},
            .curves = {{.points = std::move(points)}}};
}

PlotChart log_chart(std::vector<Vec2d> points) {
    PlotChart chart = line_chart(std::move(points));
    chart.x.scale = AxisScale::logarithmic;
    chart.y.scale = AxisScale::logarithmic;
    return chart;
}

/// The value at that fraction of an axis.
double value_at(const ResolvedAxis& axis, double at) {
    return axis.scale == AxisScale::linear ? std::lerp(axis.low, axis.high, at)
                                           : axis.low * std::pow(axis.high / axis.low, at);
}

TEST(Chart, APlaceOnThePageIsTheValueThere) {
    PlotChart chart = line_chart({{-3.0, 2e-4}, {11.0, 9e-4}});
    for (int scales = 0; scales < 4; ++scales) {
        chart.curves[0].points = {{0.02, 2e-4}, {11.0, 9e-4}, {700.0, 3.0}};
        chart.x.scale = (scales & 1) != 0 ? AxisScale::logarithmic : AxisScale::linear;
        chart.y.scale = (scales & 2) != 0 ? AxisScale::logarithmic : AxisScale::linear;
        const ChartFrame frame = chart_frame(chart, {40.0, 30.0, 500.0, 300.0});
        for (const Vec2d point : chart.curves[0].points) {
            const SvgPoint page = frame.to_page(point);
            EXPECT_TRUE(is_inside(frame.box, page));
            const Vec2d back{value_at(frame.x, (page.x - 40.0) / 500.0), value_at(frame.y, (330.0 - page.y) / 300.0)};
            // A page coordinate of some hundred px carries 1e-13 of it; a logarithm over 5 decades, 12 times that.
            EXPECT_NEAR(back.x, point.x, 1e-12 * 800.0);
            EXPECT_NEAR(back.y, point.y, 1e-12 * 4.0);
        }
    }
}

// What stands in the file, read back: the curve's path in px is where the axes' numbers say that the data are.
TEST(Chart, TheDrawnCurveIsTheData) {
    const std::string svg = chart_svg(line_chart({{0.0, 1000.0}, {2.5, 1060.0}, {10.0, 1100.0}}));
    const auto number = [&](const std::string& text) {
        const std::vector<Word> all = words(svg);
        return *std::ranges::find(all, text, &Word::text);
    };
    const auto middle = [&](const std::string& text) { return 0.5 * (number(text).left + number(text).right); };
    double x = 0.0;
    double y = 0.0;
    const std::string data = path_data(svg, "curve").at(0);
    ASSERT_EQ(std::sscanf(data.c_str() + data.find(' ', data.find(' ') + 1), "%lf %lf", &x, &y), 2) << data;
    // Two decimals of a px on each of three numbers.
    EXPECT_NEAR((x - middle("0")) / (middle("10") - middle("0")), 0.25, 1e-4);
    const double zero = number("1000").bottom - y;
    const double all = number("1000").bottom - number("1100").bottom;
    // A number's middle is 0.55 of its size above the bottom of its box.
    EXPECT_NEAR((zero - 0.55 * 11.0) / all, 0.60, 1e-4);
}

TEST(Chart, ACurveBreaksWhereThereIsNoValue) {
    const auto pieces = [](const PlotChart& chart) { return count(path_data(chart_svg(chart), "curve").at(0), "M"); };
    EXPECT_EQ(pieces(line_chart({{0, 1}, {1, 2}, {2, 3}, {3, 4}})), 1U);
    EXPECT_EQ(pieces(line_chart({{0, 1}, {1, 2}, {2, kNaN}, {3, 4}, {4, 5}})), 2U);
    EXPECT_EQ(pieces(line_chart({{0, 1}, {1, 2}, {kInfinity, 3}, {3, 4}, {4, 5}})), 2U);
    // A lone point between gaps is not lost.
    const std::string svg = chart_svg(line_chart({{0, 1}, {1, kNaN}, {2, 3}, {3, kNaN}}));
    EXPECT_EQ(count(svg, "class=\"lone\""), 2U);
}

// What lies beyond the data is shown as far as the sure part's y axis reaches.
TEST(Chart, AnUnsurePartSetsNoRangeAcrossIt) {
    PlotChart chart = line_chart({{0.0, 1.0}, {4.0, 2.0}});
    const PageBox box{0.0, 0.0, 400.0, 300.0};
    const ChartFrame sure = chart_frame(chart, box);
    chart.curves.push_back({.points = {{4.0, 2.0}, {8.0, 70.0}}, .sets_y_range = false});
    chart.areas.push_back({.outline = {{4.0, -9.0}, {8.0, -9.0}, {8.0, 99.0}}, .sets_y_range = false});
    const ChartFrame whole = chart_frame(chart, box);
    EXPECT_EQ(whole.y.low, sure.y.low);
    EXPECT_EQ(whole.y.high, sure.y.high);
    EXPECT_EQ(whole.x.high, 8.0);
}

TEST(Chart, PointsThatALogarithmicAxisCannotShowAreCounted) {
    const std::string svg = chart_svg(log_chart({{1, 1e-3}, {10, 0.0}, {100, -2.0}, {1e3, 1e-6}, {1e4, 1e-7}}));
    EXPECT_NE(svg.find("2 points are not above zero"), std::string::npos);
    EXPECT_EQ(path_data(svg, "curve").size(), 1U);
    EXPECT_EQ(chart_svg(log_chart({{1, 1}, {2, kNaN}, {3, 2}})).find("not above zero"), std::string::npos);
    EXPECT_NE(chart_svg(log_chart({{1, 0.0}})).find("no data"), std::string::npos);
}

TEST(Chart, DataBeyondFixedAxesEndAtTheFrame) {
    PlotChart chart = line_chart({{-10.0, -10.0}, {20.0, 20.0}});
    chart.x.low = 0.0;
    chart.x.high = 10.0;
    chart.y.low = 0.0;
    chart.y.high = 5.0;
    const ChartFrame frame = chart_frame(chart, {0.0, 0.0, 100.0, 100.0});
    const auto pieces = clipped_line({frame.to_page({-10.0, -10.0}), frame.to_page({20.0, 20.0})}, frame.box);
    ASSERT_EQ(pieces.size(), 1U);
    EXPECT_NEAR(pieces[0].front().x, frame.to_page({0.0, 0.0}).x, 1e-11);  // px: a tenth of a unit
    EXPECT_NEAR(pieces[0].back().x, frame.to_page({5.0, 5.0}).x, 1e-11);
    const std::vector<SvgPoint> area = clipped_polygon({{-50, -50}, {150, -50}, {150, 50}, {-50, 50}}, frame.box);
    for (const SvgPoint point : area) {
        EXPECT_TRUE(is_inside(frame.box, point));
    }
    EXPECT_EQ(area.size(), 4U);
}

TEST(Chart, AxesDoNotDegenerate) {
    const auto y_range = [](const PlotChart& chart) { return chart_frame(chart, {0, 0, 400, 300}).y; };
    for (const double value : {0.0, 1e-300, 5.0, -1e12, 1e200}) {
        const ResolvedAxis axis = y_range(line_chart({{0, value}, {1, value}}));
        EXPECT_LT(axis.low, value);
        EXPECT_GT(axis.high, value);
        EXPECT_GE(axis.ticks.major.size(), 2U) << value;
    }
    // Rounding noise about zero is not blown up to the chart's height.
    PlotChart noise = line_chart({{0, 1e-15}, {1, -2e-15}});
    noise.y.least_span = 0.2;
    EXPECT_LE(y_range(noise).low, -0.1);
    EXPECT_GE(y_range(noise).high, 0.1);
    noise.y.holds_zero = true;
    noise.curves[0].points = {{0, 0.0}, {1, 1e-15}};
    EXPECT_EQ(y_range(noise).low, 0.0);
    PlotChart symmetric = line_chart({{0, -1.0}, {1, 7.0}});
    symmetric.y.is_symmetric = true;
    EXPECT_EQ(y_range(symmetric).low, -y_range(symmetric).high);
}

TEST(Chart, AnAxisMayRunTheOtherWay) {
    PlotChart chart = line_chart({{0, 1}, {1, 2}});
    chart.x.low = 1.0;
    chart.x.high = 0.0;
    const ChartFrame frame = chart_frame(chart, {0.0, 0.0, 100.0, 100.0});
    EXPECT_EQ(frame.to_page({1.0, 1.0}).x, 0.0);
    EXPECT_EQ(frame.to_page({0.0, 1.0}).x, 100.0);
    EXPECT_TRUE(is_sound(chart_svg(chart)));
}

TEST(Chart, EqualScalesAreEqual) {
    PlotChart chart = line_chart({{-3, -1}, {3, 1}});
    chart.has_equal_scales = true;
    const ChartFrame frame = chart_frame(chart, {0.0, 0.0, 400.0, 300.0});
    const SvgPoint origin = frame.to_page({0, 0});
    EXPECT_NEAR(frame.to_page({1, 0}).x - origin.x, origin.y - frame.to_page({0, 1}).y, 1e-9);
    EXPECT_TRUE(is_inside(frame.box, frame.to_page({3, 1})));
}

TEST(Chart, WordsNeverCoverEachOther) {
    PlotChart chart{
        .title = "A title that is much longer than the chart is wide, as some are when a lens has a long name",
        .caption =
            "And a caption that goes on for several lines, since somebody wanted to say it all at once: "
            "what was measured, on which rays, and how long it took on which machine",
        .x = {.label = "Radius of curvature", .unit = "mm", .scale = AxisScale::logarithmic},
        .y = {.label = "Error", .unit = "mm", .scale = AxisScale::logarithmic}};
    for (int i = 0; i < 7; ++i) {
        ChartCurve curve{.label = "number type " + std::to_string(i),
                         .colour = series_colour(static_cast<std::size_t>(i))};
        for (int e = -3; e <= 15; ++e) {
            curve.points.push_back({std::pow(10.0, e), std::pow(10.0, -e - i)});
        }
        chart.curves.push_back(curve);
    }
    chart.references = {{.direction = ReferenceDirection::horizontal, .at = 1e-9, .label = "required"},
                        {.direction = ReferenceDirection::horizontal, .at = 2e-9, .label = "found"},
                        {.at = 1e3, .label = "onset in float"},
                        {.at = 2e3, .label = "onset in double"}};
    for (const ChartSize size : {ChartSize{}, {420, 300}, {1200, 900}, {300, 240}}) {
        EXPECT_TRUE(is_sound(chart_svg(chart, size))) << size.width;
    }
}

TEST(Chart, AnythingIsDrawnAndNothingBreaksTheFile) {
    const std::vector<double> values = {0.0, 1.0, -1e9, 1e15, 1e300, -1e300, 1e-300, kNaN, kInfinity, -kInfinity};
    for (const double a : values) {
        for (const double b : values) {
            for (PlotChart chart : {line_chart({{a, b}, {b, a}, {1.0, 2.0}}), log_chart({{a, b}, {b, a}})}) {
                chart.title = "<script>&\"'\x01";
                chart.y.low = a;
                chart.x.high = b;
                chart.references = {{.at = a, .label = "<a>"}, {.direction = ReferenceDirection::horizontal, .at = b}};
                const std::string svg = chart_svg(chart);
                EXPECT_TRUE(is_well_formed(svg)) << a << " " << b;
                EXPECT_FALSE(has_bad_number(svg)) << a << " " << b;
            }
        }
    }
    EXPECT_NE(chart_svg({}).find("no data"), std::string::npos);
    EXPECT_TRUE(is_sound(chart_svg({})));
}

TEST(ChartGrid, PanelsShareScalesAndOneLegend) {
    ChartGrid grid{.title = "Panels"};
    for (const double size : {1.0, 40.0, 3.0}) {
        PlotChart chart = line_chart({{0, -size}, {1, size}});
        chart.title = "Panel";
        chart.curves[0].label = "587.6 nm";
        grid.panels.push_back(chart);
    }
    const std::string svg = chart_grid_svg(grid);
    EXPECT_TRUE(is_sound(svg));
    EXPECT_EQ(count(svg, ">587.6 nm</text>"), 1U);
    // Numbers of y at the two panels of the first column only, all on the widest panel's scale.
    EXPECT_EQ(count(svg, ">\u221240</text>"), 2U);
    std::vector<PlotChart> charts = grid.panels;
    unite_y_ranges(charts);
    for (const PlotChart& chart : charts) {
        EXPECT_EQ(chart.y.low, -40.0);
        EXPECT_EQ(chart.y.high, 40.0);
    }
    EXPECT_TRUE(is_sound(chart_grid_svg({})));
}

TEST(Chart, TheSameChartGivesTheSameBytes) {
    const PlotChart chart = log_chart({{1, 2}, {3, 4}, {1e5, 1e-7}});
    EXPECT_EQ(chart_svg(chart), chart_svg(chart));
}

TEST(Palette, LinesLookAsTheyAreNamed) {
    const auto channel = [](const std::string& colour, std::size_t i) {
        return std::stoi(colour.substr(1 + 2 * i, 2), nullptr, 16);
    };
    const std::string blue = wavelength_colour(486.1327);
    const std::string green = wavelength_colour(546.074);
    const std::string red = wavelength_colour(656.2725);
    EXPECT_GT(channel(blue, 2), channel(blue, 0) + 100);
    EXPECT_GT(channel(green, 1), channel(green, 0) + 100);
    EXPECT_GT(channel(red, 0), channel(red, 2) + 100);
    EXPECT_EQ(wavelength_colour(kNaN), kQuiet);
    // WCAG 2's contrast of every line with white.
    for (double nm = 200.0; nm < 1500.0; nm += 7.0) {
        const auto linear = [&](std::size_t i) {
            return std::pow((channel(wavelength_colour(nm), i) / 255.0 + 0.055) / 1.055, 2.4);
        };
        const double luminance = 0.2126 * linear(0) + 0.7152 * linear(1) + 0.0722 * linear(2);
        EXPECT_GE(1.05 / (luminance + 0.05), 3.5) << nm;
    }
}

}  // namespace lensproof::draw::chart_test
