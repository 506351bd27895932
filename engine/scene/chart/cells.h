// engine/scene/chart/cells.h — the square cells of which most charts are made.
#pragma once
#include <vector>

#include "engine/base/vec.h"

namespace lensproof::scene {

/// Columns and rows.
struct GridSize {
    int columns = 0;
    int rows = 0;
};

/// A place in a grid of square cells about the origin: which cell, and where from its middle, in pitches.
struct Cell {
    int column = 0;
    int row = 0;
    double x = 0.0;
    double y = 0.0;
    bool is_on_grid = false;
};

/// Called for every camera path, as all of a chart's `is_black` is: whole numbers by conversion, which needs no
/// function call on any machine.
[[gnu::always_inline]] inline Cell cell_at(GridSize grid, double pitch_mm, double x_mm, double y_mm) {
    const double x = x_mm / pitch_mm + 0.5 * grid.columns;
    const double y = y_mm / pitch_mm + 0.5 * grid.rows;
    if (!(x >= 0.0 && x < grid.columns && y >= 0.0 && y < grid.rows)) {
        return {};
    }
    const int column = static_cast<int>(x);
    const int row = static_cast<int>(y);
    return {.column = column, .row = row, .x = x - column - 0.5, .y = y - row - 0.5, .is_on_grid = true};
}

/// Whether (x, y) mm lies in a square of side `side_mm` about the origin, left and upper edge included.
inline bool is_in_square(double x_mm, double y_mm, double side_mm) {
    const double half = 0.5 * side_mm;
    return x_mm >= -half && x_mm < half && y_mm >= -half && y_mm < half;
}

/// The middles of the cells, row by row from the top left.
inline std::vector<Vec2d> cell_middles(GridSize grid, double pitch_mm) {
    std::vector<Vec2d> middles;
    for (int row = 0; row < grid.rows; ++row) {
        for (int column = 0; column < grid.columns; ++column) {
            middles.push_back(
                {(column - 0.5 * (grid.columns - 1)) * pitch_mm, (row - 0.5 * (grid.rows - 1)) * pitch_mm});
        }
    }
    return middles;
}

}  // namespace lensproof::scene
