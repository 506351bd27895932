#include "engine/scene/chart.h"

#include <cmath>
#include <numbers>

namespace lensproof::scene {

namespace {

// Called for every camera path: whole numbers by conversion, which needs no function call on any machine, and no root
// but where a pattern turns.

/// A place in a grid of square cells about the origin: which cell, and where from its middle, in pitches.
struct Cell {
    int column = 0;
    int row = 0;
    double x = 0.0;
    double y = 0.0;
    bool is_on_grid = false;
};

Cell cell_at(GridSize grid, double pitch_mm, double x_mm, double y_mm) {
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
bool is_in_square(double x_mm, double y_mm, double side_mm) {
    const double half = 0.5 * side_mm;
    return x_mm >= -half && x_mm < half && y_mm >= -half && y_mm < half;
}

bool is_black(const Checkerboard& board, double x_mm, double y_mm) {
    const Cell cell = cell_at({board.columns, board.rows}, board.square_mm, x_mm, y_mm);
    return cell.is_on_grid && (cell.column + cell.row) % 2 == 0;
}

bool is_black(const DiscGrid& grid, double x_mm, double y_mm) {
    const Cell cell = cell_at({grid.columns, grid.rows}, grid.pitch_mm, x_mm, y_mm);
    const double radius = 0.5 * grid.diameter_mm / grid.pitch_mm;
    return cell.is_on_grid && cell.x * cell.x + cell.y * cell.y < radius * radius;
}

bool is_black(const FlatField&, double, double) {
    return false;
}

bool is_black(const CharucoBoard& board, double x_mm, double y_mm) {
    const Cell cell = cell_at({board.columns, board.rows}, board.square_mm, x_mm, y_mm);
    if (!cell.is_on_grid || (cell.column + cell.row) % 2 == 0) {
        return cell.is_on_grid;
    }
    const double x = cell.x * board.square_mm;
    const double y = cell.y * board.square_mm;
    const int side = board.cells + 2;  // with the border
    const Cell in_marker = cell_at({side, side}, board.marker_mm / side, x, y);
    if (!in_marker.is_on_grid) {
        return false;
    }
    const int column = in_marker.column - 1;
    const int row = in_marker.row - 1;
    if (column < 0 || row < 0 || column == board.cells || row == board.cells) {
        return true;
    }
    const std::size_t before = (static_cast<std::size_t>(cell.row) * board.columns + cell.column) / 2;
    const int bit = board.cells * board.cells - 1 - (row * board.cells + column);
    return (board.markers[before] >> bit & 1) == 0;
}

bool is_black(const SiemensStar& star, double x_mm, double y_mm) {
    if (!(x_mm * x_mm + y_mm * y_mm < star.radius_mm * star.radius_mm)) {
        return false;
    }
    const double turn = std::atan2(y_mm, x_mm) / (2.0 * std::numbers::pi);
    return static_cast<int>((turn < 0.0 ? turn + 1.0 : turn) * star.sectors) % 2 == 0;
}

bool is_black(const SlantedEdges& edges, double x_mm, double y_mm) {
    const Cell cell = cell_at({edges.columns, edges.rows}, edges.pitch_mm, x_mm, y_mm);
    const double angle = edges.angle_deg * std::numbers::pi / 180.0;
    const double c = std::cos(angle) * edges.pitch_mm;
    const double s = std::sin(angle) * edges.pitch_mm;
    return cell.is_on_grid && is_in_square(c * cell.x + s * cell.y, c * cell.y - s * cell.x, edges.square_mm);
}

bool is_black(const PointGrid& grid, double x_mm, double y_mm) {
    const Cell cell = cell_at({grid.columns, grid.rows}, grid.pitch_mm, x_mm, y_mm);
    const double radius = 0.5 * grid.dot_mm / grid.pitch_mm;
    return cell.is_on_grid && !(cell.x * cell.x + cell.y * cell.y < radius * radius);
}

bool is_black(const AstigmatismCrosses& crosses, double x_mm, double y_mm) {
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

bool is_black(const StraightLines& lines, double x_mm, double y_mm) {
    const Cell cell = cell_at({lines.columns, lines.rows}, lines.pitch_mm, x_mm, y_mm);
    const double half_line = 0.5 * lines.line_mm / lines.pitch_mm;
    return cell.is_on_grid && (std::abs(cell.x) < half_line || std::abs(cell.y) < half_line);
}

double pitch_mm(const ColourChecker& checker) {
    return checker.patch_mm + checker.gap_mm;
}

std::optional<int> patch_at(const ColourChecker& checker, double x_mm, double y_mm) {
    constexpr GridSize kGrid{ColourChecker::kColumns, ColourChecker::kRows};
    const Cell cell = cell_at(kGrid, pitch_mm(checker), x_mm, y_mm);
    const bool is_patch =
        cell.is_on_grid && is_in_square(cell.x * pitch_mm(checker), cell.y * pitch_mm(checker), checker.patch_mm);
    return is_patch ? std::optional(cell.row * ColourChecker::kColumns + cell.column) : std::nullopt;
}

Vec2d size_mm(const ColourChecker& checker) {
    return {ColourChecker::kColumns * pitch_mm(checker) + checker.gap_mm,
            ColourChecker::kRows * pitch_mm(checker) + checker.gap_mm};
}

bool is_black(const ColourChecker& checker, double x_mm, double y_mm) {
    const Vec2d size = size_mm(checker);
    return std::abs(x_mm) < 0.5 * size.x && std::abs(y_mm) < 0.5 * size.y && !patch_at(checker, x_mm, y_mm);
}

/// What is to be said of a kind: its name, its points, and how large it is.
struct Kind {
    const char* name;
    GridSize grid;
    double pitch_mm = 0.0;
    Vec2d size_mm;
};

Kind cells_of(const char* name, const auto& grid) {
    return {name, {grid.columns, grid.rows}, grid.pitch_mm, {grid.columns * grid.pitch_mm, grid.rows * grid.pitch_mm}};
}

Kind board_of(const char* name, const auto& board) {
    return {name,
            {board.columns - 1, board.rows - 1},
            board.square_mm,
            {board.columns * board.square_mm, board.rows * board.square_mm}};
}

Kind kind_of(const Checkerboard& board) {
    return board_of("checkerboard", board);
}
Kind kind_of(const DiscGrid& grid) {
    return cells_of("disc-grid", grid);
}
Kind kind_of(const FlatField&) {
    return {.name = "flat-field"};
}
Kind kind_of(const CharucoBoard& board) {
    return board_of("charuco", board);
}
Kind kind_of(const SiemensStar& star) {
    return {"siemens-star", {1, 1}, 0.0, {2.0 * star.radius_mm, 2.0 * star.radius_mm}};
}
Kind kind_of(const SlantedEdges& edges) {
    return cells_of("slanted-edges", edges);
}
Kind kind_of(const PointGrid& grid) {
    return cells_of("point-grid", grid);
}
Kind kind_of(const AstigmatismCrosses& crosses) {
    return cells_of("astigmatism-crosses", crosses);
}
Kind kind_of(const StraightLines& lines) {
    return cells_of("straight-lines", lines);
}
Kind kind_of(const ColourChecker& checker) {
    return {"colour-checker", {ColourChecker::kColumns, ColourChecker::kRows}, pitch_mm(checker), size_mm(checker)};
}

Kind kind_of(const Chart& chart) {
    return std::visit([](const auto& pattern) { return kind_of(pattern); }, chart.pattern);
}

}  // namespace

bool is_black(const Chart& chart, double x_mm, double y_mm) {
    return std::visit([&](const auto& pattern) { return is_black(pattern, x_mm, y_mm); }, chart.pattern);
}

double reflectance(const Chart& chart, double x_mm, double y_mm) {
    return is_black(chart, x_mm, y_mm) ? chart.black_reflectance : chart.white_reflectance;
}

std::optional<int> patch_index(const Chart& chart, double x_mm, double y_mm) {
    const auto* checker = std::get_if<ColourChecker>(&chart.pattern);
    return checker != nullptr ? patch_at(*checker, x_mm, y_mm) : std::nullopt;
}

GridSize feature_grid(const Chart& chart) {
    return kind_of(chart).grid;
}

std::vector<Vec2d> feature_points(const Chart& chart) {
    const Kind kind = kind_of(chart);
    std::vector<Vec2d> points;
    for (int row = 0; row < kind.grid.rows; ++row) {
        for (int column = 0; column < kind.grid.columns; ++column) {
            points.push_back({(column - 0.5 * (kind.grid.columns - 1)) * kind.pitch_mm,
                              (row - 0.5 * (kind.grid.rows - 1)) * kind.pitch_mm});
        }
    }
    return points;
}

Vec2d pattern_size_mm(const Chart& chart) {
    return kind_of(chart).size_mm;
}

std::string kind_name(const Chart& chart) {
    return kind_of(chart).name;
}

}  // namespace lensproof::scene
