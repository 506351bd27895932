#include "experiments/studies/certainty_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "experiments/draw/chart.h"
#include "experiments/draw/palette.h"

namespace lensproof::studies {

namespace {

constexpr double kFrameWidth = 380.0;      // of each drawing, of the page
constexpr std::size_t kFineColumns = 190;  // of the colours
constexpr const char* kHullColour = "#b5003c";
constexpr const char* kHatchOnColours = "#ffffff";
constexpr const char* kHatchOnPaper = "#aab0ba";

std::vector<Vec2d> points_used(const calibration::Profile& profile) {
    std::vector<Vec2d> points;
    for (const calibration::ProfileView& view : profile.views) {
        for (const calibration::ProfilePoint& point : view.points) {
            if (point.used) {
                points.push_back(point.image_px);
            }
        }
    }
    return points;
}

/// Between the map's knots, bilinear; NaN where one of them is not imaged.
double uncertainty_at(const calibration::UncertaintyMap& map, double column, double row) {
    const int i = std::clamp(static_cast<int>(column), 0, map.columns - 2);
    const int j = std::clamp(static_cast<int>(row), 0, map.rows - 2);
    const auto knot = [&](int di, int dj) {
        return map.far_px
            .at(static_cast<std::size_t>(j + dj) * static_cast<std::size_t>(map.columns) +
                static_cast<std::size_t>(i + di))
            .value_or(kNaN);
    };
    const double u = column - i;
    const double v = row - j;
    return std::lerp(std::lerp(knot(0, 0), knot(1, 0), u), std::lerp(knot(0, 1), knot(1, 1), u), v);
}

draw::HeatMap heat_map(const calibration::Profile& profile, const draw::AxisRange& range) {
    const calibration::UncertaintyMap& knots = *profile.geometry->uncertainty;
    const double width = profile.width_px;
    const double height = profile.height_px;
    draw::HeatMap map{.columns = kFineColumns,
                      .rows = std::max<std::size_t>(2, std::lround(kFineColumns * height / width)),
                      .x = {-0.5, width - 0.5},
                      .y = {-0.5, height - 0.5},
                      .colours = draw::ColourMap::sequential,
                      .scale = draw::AxisScale::logarithmic,
                      .range = range,
                      .label = "projection uncertainty, 1 σ",
                      .unit = "px"};
    map.values.reserve(map.columns * map.rows);
    for (std::size_t j = 0; j < map.rows; ++j) {
        for (std::size_t i = 0; i < map.columns; ++i) {
            const auto place = [](std::size_t at, std::size_t count, int knots_there) {
                return (static_cast<double>(at) + 0.5) / static_cast<double>(count) * (knots_there - 1);
            };
            map.values.push_back(
                uncertainty_at(knots, place(i, map.columns, knots.columns), place(j, map.rows, knots.rows)));
        }
    }
    return map;
}

/// The part of the line x + y = sum (both in units of the frame) inside a convex polygon, by x; none where it misses.
std::optional<draw::AxisRange> crossing(const std::vector<Vec2d>& polygon, double sum) {
    draw::AxisRange inside{kInfinity, -kInfinity};
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

draw::ChartCurve hatching(const std::vector<Vec2d>& hull, double width, double height, const std::string& colour) {
    draw::ChartCurve curve{.label = "", .points = {}, .colour = colour, .width = 0.8};
    for (const std::vector<Vec2d>& piece : hatching_outside(hull, width, height, width / 45.0)) {
        curve.points.insert(curve.points.end(), piece.begin(), piece.end());
        curve.points.push_back({kNaN, kNaN});
    }
    return curve;
}

draw::ChartCurve outline(std::vector<Vec2d> hull) {
    if (!hull.empty()) {
        hull.push_back(hull.front());
    }
    return {.label = "hull of the points; hatched outside: extrapolated",
            .points = std::move(hull),
            .colour = kHullColour,
            .width = 1.8};
}

draw::PlotChart empty_frame(const calibration::Profile& profile, const std::string& title) {
    return {.title = title,
            .x = {.label = "x", .unit = "px", .low = -0.5, .high = profile.width_px - 0.5},
            .y = {.label = "y", .unit = "px", .low = profile.height_px - 0.5, .high = -0.5}};
}

/// "0.004 px at the best place, at most 0.012 px inside the points' hull (71 % of the frame), 0.3 px in a corner".
std::string in_words(const calibration::Profile& profile) {
    const calibration::UncertaintyMap& map = *profile.geometry->uncertainty;
    double best = kInfinity;
    double covered = 0.0;
    double anywhere = 0.0;
    std::size_t inside = 0;
    std::size_t imaged = 0;
    for (std::size_t i = 0; i < map.far_px.size(); ++i) {
        inside += map.covered[i] ? 1 : 0;
        if (map.far_px[i]) {
            ++imaged;
            best = std::min(best, *map.far_px[i]);
            anywhere = std::max(anywhere, *map.far_px[i]);
            covered = map.covered[i] ? std::max(covered, *map.far_px[i]) : covered;
        }
    }
    if (imaged == 0) {
        return "nothing in the frame is imaged by the model";
    }
    return fmt::format(
        "A far point is imaged to {:.2g} px (1 σ) at the best place, to {:.2g} px inside the hull of the points "
        "({:.0f} % "
        "of the frame), and to {:.2g} px at the worst place of the frame. Noise alone: what the model cannot express "
        "is "
        "not in it.",
        best, covered, 100.0 * static_cast<double>(inside) / static_cast<double>(map.covered.size()), anywhere);
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
        const draw::AxisRange all{std::max(low, sum - (height + low)), std::min(width + low, sum - low)};
        const auto add = [&](double from, double to) {
            if (to > from) {
                pieces.push_back({{from, sum - from}, {to, sum - to}});
            }
        };
        const std::optional<draw::AxisRange> inside = crossing(polygon, sum);
        add(all.low, inside ? std::min(inside->low, all.high) : all.high);
        if (inside) {
            add(std::max(inside->high, all.low), all.high);
        }
    }
    return pieces;
}

draw::AxisRange certainty_range(const std::vector<const calibration::Profile*>& profiles) {
    draw::AxisRange range{kInfinity, 0.0};
    for (const calibration::Profile* profile : profiles) {
        if (!profile->geometry || !profile->geometry->uncertainty) {
            continue;
        }
        const calibration::UncertaintyMap& map = *profile->geometry->uncertainty;
        for (std::size_t i = 0; i < map.far_px.size(); ++i) {
            if (map.covered[i] && map.far_px[i] && *map.far_px[i] > 0.0) {
                range = {std::min(range.low, *map.far_px[i]), std::max(range.high, *map.far_px[i])};
            }
        }
    }
    return range.low <= range.high ? draw::AxisRange{range.low, 10.0 * range.high} : draw::AxisRange{1e-3, 1.0};
}

CertaintyMap certainty_map(const calibration::Profile& profile, const std::string& title, const std::string& colour,
                           const draw::AxisRange& range) {
    const double width = profile.width_px;
    const double height = profile.height_px;
    const std::vector<Vec2d> points = points_used(profile);
    const std::vector<Vec2d> hull = calibration::convex_hull(points);
    draw::PlotChart certainty = empty_frame(profile, "How sure the projection is");
    certainty.map = heat_map(profile, range);
    certainty.curves = {hatching(hull, width, height, kHatchOnColours), outline(hull)};
    draw::PlotChart coverage = empty_frame(profile, fmt::format("From {} points", points.size()));
    coverage.curves = {hatching(hull, width, height, kHatchOnPaper),
                       outline(hull),
                       {.label = "points used",
                        .points = points,
                        .colour = colour,
                        .line = draw::CurveLine::none,
                        .marker = draw::CurveMarker::dot,
                        .marker_size = points.size() > 1500 ? 1.6 : 2.6}};
    return {in_words(profile), draw::chart_grid_svg({.title = title,
                                                     .caption = "",
                                                     .panels = {certainty, coverage},
                                                     .columns = 2,
                                                     .shares_x = false,
                                                     .shares_y = false,
                                                     .frame = {kFrameWidth, kFrameWidth * height / width}})};
}

}  // namespace lensproof::studies
