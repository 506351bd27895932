// engine/scene/chart/charuco_board.h — a checkerboard with markers that say which of its corners is which.
#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/kinds.h"
#include "engine/scene/chart/aruco.h"
#include "engine/scene/chart/chart_traits.h"
#include "engine/scene/chart/outline.h"

namespace lensproof::scene {

/// A checkerboard with an ArUco marker in the middle of each white square, the first at the top, numbered row by row
/// (OpenCV's `CharucoBoard` of version 4.7 and later, without its legacy pattern).
struct CharucoBoard {
    static constexpr KindNames<> kNames{"charuco"};
    int columns = 0;
    int rows = 0;
    double square_mm = 0.0;
    double marker_mm = 0.0;              // with the marker's own black border, one cell wide
    int cells = 0;                       // of a marker's pattern, along a side: 4, 5 or 6
    std::vector<std::uint64_t> markers;  // by number: cells row by row from the top left, white 1, the last one lowest
};

void visit_keys(CharucoBoard& board, auto& keys) {
    keys.grid("squares", board.columns, board.rows, {.least = 2, .printed = {10, 7}});
    keys.pitch("square_mm", board.square_mm, {board.columns, board.rows});
    keys.part("marker_mm", board.marker_mm,
              {.of = "square_mm", .most_mm = board.square_mm, .printed_mm = 0.72 * board.square_mm});
    const auto needed = static_cast<std::size_t>(board.columns) * static_cast<std::size_t>(board.rows) / 2;
    const std::string name = keys.choice("dictionary", known_aruco_dictionaries(),
                                         needed <= 50    ? "DICT_5X5_50"
                                         : needed <= 100 ? "DICT_5X5_100"
                                                         : "DICT_5X5_250");
    if (name.empty()) {
        return;
    }
    ArucoDictionary dictionary = aruco_dictionary(name);
    if (needed > dictionary.markers.size()) {
        keys.refuse("squares", "has " + std::to_string(needed) + " white squares, more than the " +
                                   std::to_string(dictionary.markers.size()) + " markers of " + name);
    }
    board.cells = dictionary.cells;
    board.markers = std::move(dictionary.markers);
}

/// Whether a cell of a marker, counted from 0 within its border, is white.
inline bool is_white(const CharucoBoard& board, std::uint64_t marker, int column, int row) {
    return (marker >> (board.cells * board.cells - 1 - (row * board.cells + column)) & 1U) != 0;
}

inline bool is_black(const CharucoBoard& board, double x_mm, double y_mm) {
    const Cell cell = cell_at({board.columns, board.rows}, board.square_mm, x_mm, y_mm);
    if (!cell.is_on_grid || (cell.column + cell.row) % 2 == 0) {
        return cell.is_on_grid;
    }
    const int side = board.cells + 2;  // with the border
    const Cell in_marker =
        cell_at({side, side}, board.marker_mm / side, cell.x * board.square_mm, cell.y * board.square_mm);
    if (!in_marker.is_on_grid) {
        return false;
    }
    const int column = in_marker.column - 1;
    const int row = in_marker.row - 1;
    if (column < 0 || row < 0 || column == board.cells || row == board.cells) {
        return true;
    }
    const std::size_t before = (static_cast<std::size_t>(cell.row) * board.columns + cell.column) / 2;
    return !is_white(board, board.markers[before], column, row);
}

inline ChartTraits traits(const CharucoBoard& board) {
    const double margin_mm = 0.5 * (board.square_mm - board.marker_mm);
    return {.points = {board.columns - 1, board.rows - 1},
            .pitch_mm = board.square_mm,
            .size_mm = {board.columns * board.square_mm, board.rows * board.square_mm},
            .look = MarkedCorners{.clear_squares = 0.5 * (1.0 - board.marker_mm / board.square_mm)},
            .edges = CellSides{.even_mm = margin_mm},
            .narrowest_mm = std::min(board.marker_mm / (board.cells + 2), margin_mm)};
}

/// The squares, and of each marker its black one with white cells upon it, those that stand side by side in one piece.
inline Outline outline(const CharucoBoard& board) {
    Outline outline = board_squares({board.columns, board.rows}, board.square_mm);
    const double half = 0.5 * board.marker_mm;
    const double cell = board.marker_mm / (board.cells + 2);
    auto marker = board.markers.begin();
    for (int i = 0; i < board.columns * board.rows; ++i) {
        const int across = i % board.columns;
        const int down = i / board.columns;
        if ((across + down) % 2 == 0) {
            continue;
        }
        const Vec2d centre{(across + 0.5 - 0.5 * board.columns) * board.square_mm,
                           (down + 0.5 - 0.5 * board.rows) * board.square_mm};
        outline.push_back(rectangle({centre.x - half, centre.y - half}, {centre.x + half, centre.y + half}));
        for (int row = 0; row < board.cells; ++row) {
            for (int column = 0; column < board.cells; ++column) {
                const int first = column;
                while (column < board.cells && is_white(board, *marker, column, row)) {
                    ++column;
                }
                if (column > first) {
                    const double y = centre.y - half + (row + 1) * cell;
                    outline.push_back(rectangle({centre.x - half + (first + 1) * cell, y},
                                                {centre.x - half + (column + 1) * cell, y + cell}, false));
                }
            }
        }
        ++marker;
    }
    return outline;
}

}  // namespace lensproof::scene
