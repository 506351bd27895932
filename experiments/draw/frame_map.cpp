#include "experiments/draw/frame_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"

namespace lensproof::draw {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
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

HeatMap heat_map(const FrameMap& knots, const AxisRange& range) {
    const double width = knots.width_px;
    const double height = knots.height_px;
    HeatMap map{.columns = kFineColumns,
                .rows = std::max<std::size_t>(2, std::lround(kFineColumns * height / width)),
                .x = {-0.5, width - 0.5},
                .y = {-0.5, height - 0.5},
                .colours = ColourMap::sequential,
                .scale = AxisScale::logarithmic,
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

/// The part of the line x + y = sum (both in units of the frame) inside a convex polygon, by x; none where it misses.
std::optional<AxisRange> crossing(const std::vector<Vec2d>& polygon, double sum) {
    AxisRange inside{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec2d a = polygon[i];
        const Vec2d b = polygon[(i + 1) % polygon.size()];
        const double from = a.x + a.y - sum;
        const double to = b.x + b.y - sum;
        if (from * to <= 0.0 && from != to) {
            const double x = std::lerp(a.x, b.x, from / (from - to));
            inside = {std::min(inside.low, x), std::max(inside.high, x)};
        }
    }
    return inside.low < inside.high ? std::optional(inside) : std::nullopt;
}

ChartCurve hatching(const std::vector<Vec2d>& hull, double width, double height, const std::string& colour) {
    ChartCurve curve{.label = "", .points = {}, .colour = colour, .width = 0.8};
    for (const std::vector<Vec2d>& piece : hatching_outside(hull, width, height, width / 45.0)) {
        curve.points.insert(curve.points.end(), piece.begin(), piece.end());
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

PlotChart empty_frame(const FrameMap& map, const std::string& title) {
    return {.title = title,
            .x = {.label = "x", .unit = "px", .low = -0.5, .high = map.width_px - 0.5},
            .y = {.label = "y", .unit = "px", .low = map.height_px - 0.5, .high = -0.5}};
}

}  // namespace

std::vector<std::vector<Vec2d>> hatching_outside(const std::vector<Vec2d>& polygon, double width, double height,
                                                 double step) {
    std::vector<std::vector<Vec2d>> pieces;
    if (polygon.size() < 3 || !(step > 0.0)) {
        return pieces;
    }
    const double low = -0.5;
    for (double sum = 2.0 * low + step; sum < width + height + 2.0 * low; sum += step) {
        const AxisRange all{std::max(low, sum - (height + low)), std::min(width + low, sum - low)};
        const auto add = [&](double from, double to) {
            if (to > from) {
                pieces.push_back({{from, sum - from}, {to, sum - to}});
            }
        };
        const std::optional<AxisRange> inside = crossing(polygon, sum);
        add(all.low, inside ? std::min(inside->low, all.high) : all.high);
        if (inside) {
            add(std::max(inside->high, all.low), all.high);
        }
    }
    return pieces;
}

AxisRange common_range(const std::vector<const FrameMap*>& maps) {
    AxisRange range{std::numeric_limits<double>::infinity(), 0.0};
    for (const FrameMap* map : maps) {
        for (std::size_t i = 0; i < map->values.size(); ++i) {
            if (map->covered[i] && map->values[i] > 0.0) {
                range = {std::min(range.low, map->values[i]), std::max(range.high, map->values[i])};
            }
        }
    }
    return range.low <= range.high ? AxisRange{range.low, 10.0 * range.high} : AxisRange{1e-3, 1.0};
}

std::string frame_map_svg(const FrameMap& map, const AxisRange& range, const std::string& colour) {
    const double width = map.width_px;
    const double height = map.height_px;
    PlotChart values = empty_frame(map, map.heading);
    values.map = heat_map(map, range);
    values.curves = {hatching(map.hull, width, height, kHatchOnColours), outline(map.hull)};
    PlotChart coverage = empty_frame(map, fmt::format("From {} points", map.points.size()));
    coverage.curves = {hatching(map.hull, width, height, kHatchOnPaper),
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
                           .shares_x = false,
                           .shares_y = false,
                           .frame = {kFrameWidth, kFrameWidth * height / width}});
}

}  // namespace lensproof::draw
