// engine/scene/chart/checkerboard.h — black and white squares in turn.
#pragma once
#include "engine/base/kinds.h"
#include "engine/scene/chart/chart_traits.h"
#include "engine/scene/chart/outline.h"

namespace lensproof::scene {

/// `columns` × `rows` squares of side `square_mm`; the square at the top left is black.
struct Checkerboard {
    static constexpr KindNames<> kNames{"checkerboard"};
    int columns = 0;
    int rows = 0;
    double square_mm = 0.0;
};

void visit_keys(Checkerboard& board, auto& keys) {
    keys.grid("squares", board.columns, board.rows, {.least = 3, .printed = {10, 7}});
    keys.pitch("square_mm", board.square_mm, {board.columns, board.rows});
}

inline bool is_black(const Checkerboard& board, double x_mm, double y_mm) {
    const Cell cell = cell_at({board.columns, board.rows}, board.square_mm, x_mm, y_mm);
    return cell.is_on_grid && (cell.column + cell.row) % 2 == 0;
}

inline ChartTraits traits(const Checkerboard& board) {
    return {.points = {board.columns - 1, board.rows - 1},
            .pitch_mm = board.square_mm,
            .size_mm = {board.columns * board.square_mm, board.rows * board.square_mm},
            .look = SquareCorners(),
            .edges = CellSides{.even_mm = board.square_mm},
            .white = WhiteCells::odd,
            .narrowest_mm = board.square_mm};
}

inline Outline outline(const Checkerboard& board) {
    return board_squares({board.columns, board.rows}, board.square_mm);
}

}  // namespace lensproof::scene
