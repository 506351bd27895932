// engine/scene/chart/point_grid.h — white dots on black, so small that they show what a lens makes of a point.
#pragma once
#include <algorithm>

#include "engine/base/kinds.h"
#include "engine/scene/chart/chart_traits.h"
#include "engine/scene/chart/outline.h"

namespace lensproof::scene {

/// White dots of diameter `dot_mm` on black cells of side `pitch_mm`, each in the middle of its cell.
struct PointGrid {
    static constexpr KindNames<> kNames{"point-grid"};
    int columns = 0;
    int rows = 0;
    double pitch_mm = 0.0;
    double dot_mm = 0.0;
};

void visit_keys(PointGrid& grid, auto& keys) {
    keys.grid("points", grid.columns, grid.rows, {.least = 1, .printed = {10, 7}});
    keys.pitch("pitch_mm", grid.pitch_mm, {grid.columns, grid.rows});
    keys.part("dot_mm", grid.dot_mm, {.of = "pitch_mm", .most_mm = grid.pitch_mm, .printed_mm = 0.3 * grid.pitch_mm});
}

inline bool is_black(const PointGrid& grid, double x_mm, double y_mm) {
    const Cell cell = cell_at({grid.columns, grid.rows}, grid.pitch_mm, x_mm, y_mm);
    const double radius = 0.5 * grid.dot_mm / grid.pitch_mm;
    return cell.is_on_grid && !(cell.x * cell.x + cell.y * cell.y < radius * radius);
}

inline ChartTraits traits(const PointGrid& grid) {
    return {.points = {grid.columns, grid.rows},
            .pitch_mm = grid.pitch_mm,
            .size_mm = {grid.columns * grid.pitch_mm, grid.rows * grid.pitch_mm},
            .look = Spots{.name = "dots",
                          .radius_pitches = 0.5 * grid.dot_mm / grid.pitch_mm,
                          .moment_diameter_mm = grid.dot_mm,
                          .is_bright = true},
            .narrowest_mm = std::min(grid.dot_mm, grid.pitch_mm - grid.dot_mm)};
}

inline Outline outline(const PointGrid& grid) {
    Outline outline{rectangle(traits(grid).size_mm)};
    for (const Vec2d& centre : cell_middles({grid.columns, grid.rows}, grid.pitch_mm)) {
        outline.push_back({OutlineDisc{centre, 0.5 * grid.dot_mm}, false});
    }
    return outline;
}

}  // namespace lensproof::scene
