#include "experiments/draw/frame_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/clipping.h"
#include "experiments/draw/palette.h"

namespace lensproof::draw {

namespace {

constexpr double kFrameWidth = 380.0;      // of each drawing, of the page
constexpr std::size_t kFineColumns = 190;  // of the colours
constexpr const char* kHullColour = "#b5003c";
constexpr const char* kHatchOnColours = "#ffffff";
constexpr const char* kHatchOnPaper = "#aab0ba";

/// Between the map's knots, bilinear; NaN where one of them is not imaged.
double value_at(const FrameMap& map, double column, double row) {
    const int i = std::clamp(static_cast<int>(column), 0, map.columns - 2);
    const int j = std::clamp(static_cast<int>(row), 0, map.rows - 2);
    const auto knot = [&](int di, int dj) {
        return map.values.at(static_cast<std::size_t>(j + dj) * static_cast<std::size_t>(map.columns) +
                             static_cast<std::size_t>(i + di));
    };
    const double u = column - i;
    const double v = row - j;
    return std::lerp(std::lerp(knot(0, 0), knot(1, 0), u), std::lerp(knot(0, 1), knot(1, 1), u), v);
}

/// Where the values are extrapolated, if there is a hull at all.
ChartCurve hatching_outside(const FrameMap& map, const std::string& colour) {
    const double right = map.width_px - 0.5;
    const double bottom = map.height_px - 0.5;
    ChartCurve curve{.colour = colour, .width = 0.8};
    std::vector<SvgPoint> hull;
    for (const Vec2d& point : map.hull) {
        hull.push_back({point.x, point.y});
    }
    if (hull.size() < 3) {
        return curve;
    }
    const std::vector<SvgPoint> frame = {{-0.5, -0.5}, {right, -0.5}, {right, bottom}, {-0.5, bottom}};
    for (const std::vector<SvgPoint>& line : hatching({frame, hull}, map.width_px / 45.0, -1.0)) {
        for (const SvgPoint& end : line) {
            curve.points.push_back({end.x, end.y});
        }
        curve.points.push_back({kNaN, kNaN});
    }
    return curve;
}

ChartCurve outline(std::vector<Vec2d> hull) {
    if (!hull.empty()) {
        hull.push_back(hull.front());
    }
    return {.label = "hull of the points; hatched outside: extrapolated",
            .points = std::move(hull),
            .colour = kHullColour,
            .width = 1.8};
}

}  // namespace

PlotChart frame_chart(const FrameMap& map, const std::string& title) {
    return {.title = title,
            .x = {.label = "x", .unit = "px", .low = -0.5, .high = map.width_px - 0.5},
            .y = {.label = "y", .unit = "px", .low = map.height_px - 0.5, .high = -0.5}};
}

HeatMap frame_heat_map(const FrameMap& knots, const AxisRange& range, AxisScale scale) {
    const double width = knots.width_px;
    const double height = knots.height_px;
    HeatMap map{.columns = kFineColumns,
                .rows = std::max<std::size_t>(2, std::lround(kFineColumns * height / width)),
                .x = {-0.5, width - 0.5},
                .y = {-0.5, height - 0.5},
                .colours = ColourMap::sequential,
                .scale = scale,
                .range = range,
                .label = knots.label,
                .unit = knots.unit};
    map.values.reserve(map.columns * map.rows);
    for (std::size_t j = 0; j < map.rows; ++j) {
        for (std::size_t i = 0; i < map.columns; ++i) {
            const auto place = [](std::size_t at, std::size_t count, int knots_there) {
                return (static_cast<double>(at) + 0.5) / static_cast<double>(count) * (knots_there - 1);
            };
            map.values.push_back(value_at(knots, place(i, map.columns, knots.columns), place(j, map.rows, knots.rows)));
        }
    }
    return map;
}

AxisRange common_range(const std::vector<const FrameMap*>& maps) {
    AxisRange range{kInfinity, 0.0};
    double anywhere = 0.0;
    for (const FrameMap* map : maps) {
        for (std::size_t i = 0; i < map->values.size(); ++i) {
            anywhere = std::isnan(map->values[i]) ? anywhere : std::max(anywhere, map->values[i]);
            if (map->covered[i] && map->values[i] > 0.0) {
                range = {std::min(range.low, map->values[i]), std::max(range.high, map->values[i])};
            }
        }
    }
    const double high = std::min(10.0 * range.high, anywhere);
    return range.low < high ? AxisRange{range.low, high} : AxisRange{1e-3, 1.0};
}

std::string frame_map_svg(const FrameMap& map, const AxisRange& range, const std::string& colour) {
    const double width = map.width_px;
    const double height = map.height_px;
    PlotChart values = frame_chart(map, map.heading);
    values.map = frame_heat_map(map, range, AxisScale::logarithmic);
    values.curves = {hatching_outside(map, kHatchOnColours), outline(map.hull)};
    PlotChart coverage = frame_chart(map, fmt::format("From {} points", map.points.size()));
    coverage.curves = {hatching_outside(map, kHatchOnPaper),
                       outline(map.hull),
                       {.label = "points used",
                        .points = map.points,
                        .colour = colour,
                        .line = CurveLine::none,
                        .marker = CurveMarker::dot,
                        .marker_size = map.points.size() > 1500 ? 1.6 : 2.6}};
    return chart_grid_svg({.title = map.title,
                           .caption = "",
                           .panels = {values, coverage},
                           .columns = 2,
                           .has_common_x = false,
                           .has_common_y = false,
                           .frame = {kFrameWidth, kFrameWidth * height / width}});
}

}  // namespace lensproof::draw
