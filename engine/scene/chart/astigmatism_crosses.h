// engine/scene/chart/astigmatism_crosses.h — crosses whose two lines come to a focus apart where there is astigmatism.
#pragma once
#include <cmath>
#include <numbers>

#include "engine/base/kinds.h"
#include "engine/scene/chart/chart_traits.h"
#include "engine/scene/chart/outline.h"

namespace lensproof::scene {

/// Black crosses, each of a line along the radius from the chart's centre and one at right angles to it. At the centre
/// itself, the lines run along x and y.
struct AstigmatismCrosses {
    static constexpr KindNames<> kNames{"astigmatism-crosses"};
    int columns = 0;
    int rows = 0;
    double pitch_mm = 0.0;
    double length_mm = 0.0;  // of a line, and
    double line_mm = 0.0;    // its width
};

void visit_keys(AstigmatismCrosses& crosses, auto& keys) {
    keys.grid("crosses", crosses.columns, crosses.rows, {.least = 1, .printed = {9, 7}});
    keys.pitch("pitch_mm", crosses.pitch_mm, {crosses.columns, crosses.rows});
    keys.part("length_mm", crosses.length_mm,
              {.of = "what of pitch_mm a turned line may have",
               .most_mm = crosses.pitch_mm / std::numbers::sqrt2,
               .printed_mm = 0.6 * crosses.pitch_mm});
    keys.part("line_mm", crosses.line_mm,
              {.of = "length_mm", .most_mm = crosses.length_mm, .printed_mm = 0.02 * crosses.pitch_mm});
}

inline bool is_black(const AstigmatismCrosses& crosses, double x_mm, double y_mm) {
    const Cell cell = cell_at({crosses.columns, crosses.rows}, crosses.pitch_mm, x_mm, y_mm);
    if (!cell.is_on_grid) {
        return false;
    }
    const double radius_x = cell.column - 0.5 * (crosses.columns - 1);
    const double radius_y = cell.row - 0.5 * (crosses.rows - 1);
    const double radius = std::sqrt(radius_x * radius_x + radius_y * radius_y);
    const double c = radius > 0.0 ? radius_x / radius : 1.0;
    const double s = radius > 0.0 ? radius_y / radius : 0.0;
    const double along = std::abs(c * cell.x + s * cell.y) * crosses.pitch_mm;
    const double across = std::abs(c * cell.y - s * cell.x) * crosses.pitch_mm;
    const double half_length = 0.5 * crosses.length_mm;
    const double half_line = 0.5 * crosses.line_mm;
    return (along < half_length && across < half_line) || (along < half_line && across < half_length);
}

inline ChartTraits traits(const AstigmatismCrosses& crosses) {
    return {.points = {crosses.columns, crosses.rows},
            .pitch_mm = crosses.pitch_mm,
            .size_mm = {crosses.columns * crosses.pitch_mm, crosses.rows * crosses.pitch_mm},
            .look = Unsearched()};
}

inline Outline outline(const AstigmatismCrosses& crosses) {
    Outline outline;
    for (const Vec2d& centre : cell_middles({crosses.columns, crosses.rows}, crosses.pitch_mm)) {
        const double radius = std::hypot(centre.x, centre.y);
        const Vec2d along = radius > 0.0 ? Vec2d{centre.x / radius, centre.y / radius} : Vec2d{1.0, 0.0};
        outline.push_back(rectangle(centre, along, crosses.length_mm, crosses.line_mm));
        outline.push_back(rectangle(centre, along, crosses.line_mm, crosses.length_mm));
    }
    return outline;
}

}  // namespace lensproof::scene
