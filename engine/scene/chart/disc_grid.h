// engine/scene/chart/disc_grid.h — black discs in rows and columns.
#pragma once
#include <algorithm>

#include "engine/base/kinds.h"
#include "engine/scene/chart/chart_traits.h"
#include "engine/scene/chart/outline.h"

namespace lensproof::scene {

/// Black discs of diameter `diameter_mm` whose centres stand `pitch_mm` apart.
struct DiscGrid {
    static constexpr KindNames<> kNames{"disc-grid"};
    int columns = 0;
    int rows = 0;
    double pitch_mm = 0.0;
    double diameter_mm = 0.0;
};

void visit_keys(DiscGrid& grid, auto& keys) {
    keys.grid("discs", grid.columns, grid.rows, {.least = 2, .printed = {10, 7}});
    keys.pitch("pitch_mm", grid.pitch_mm, {grid.columns, grid.rows});
    keys.part("diameter_mm", grid.diameter_mm,
              {.of = "pitch_mm", .most_mm = grid.pitch_mm, .printed_mm = 0.5 * grid.pitch_mm});
}

inline bool is_black(const DiscGrid& grid, double x_mm, double y_mm) {
    const Cell cell = cell_at({grid.columns, grid.rows}, grid.pitch_mm, x_mm, y_mm);
    const double radius = 0.5 * grid.diameter_mm / grid.pitch_mm;
    return cell.is_on_grid && cell.x * cell.x + cell.y * cell.y < radius * radius;
}

inline ChartTraits traits(const DiscGrid& grid) {
    return {.points = {grid.columns, grid.rows},
            .pitch_mm = grid.pitch_mm,
            .size_mm = {grid.columns * grid.pitch_mm, grid.rows * grid.pitch_mm},
            .look = Spots{.name = "discs",
                          .radius_pitches = 0.5 * grid.diameter_mm / grid.pitch_mm,
                          .moment_diameter_mm = grid.diameter_mm},
            .white = WhiteCells::all,
            .narrowest_mm = std::min(grid.diameter_mm, grid.pitch_mm - grid.diameter_mm)};
}

inline Outline outline(const DiscGrid& grid) {
    Outline outline;
    for (const Vec2d& centre : cell_middles({grid.columns, grid.rows}, grid.pitch_mm)) {
        outline.push_back({OutlineDisc{centre, 0.5 * grid.diameter_mm}});
    }
    return outline;
}

}  // namespace lensproof::scene
