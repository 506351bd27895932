#include "engine/scene/chart_outline.h"

#include <cmath>
#include <numbers>

namespace lensproof::scene {

namespace {

using Shapes = std::vector<OutlineShape>;

void add_rectangle(Shapes& shapes, const Vec2d& least, const Vec2d& most, bool is_black = true) {
    shapes.push_back(
        {OutlinePolygon{{{least.x, least.y}, {most.x, least.y}, {most.x, most.y}, {least.x, most.y}}}, is_black});
}

/// A rectangle about `centre` of which two sides run along `along` (of length 1).
void add_turned(Shapes& shapes, const Vec2d& centre, const Vec2d& along, double length_mm, double width_mm) {
    const Vec2d a{0.5 * length_mm * along.x, 0.5 * length_mm * along.y};
    const Vec2d b{-0.5 * width_mm * along.y, 0.5 * width_mm * along.x};
    shapes.push_back({OutlinePolygon{{{centre.x - a.x - b.x, centre.y - a.y - b.y},
                                      {centre.x + a.x - b.x, centre.y + a.y - b.y},
                                      {centre.x + a.x + b.x, centre.y + a.y + b.y},
                                      {centre.x - a.x + b.x, centre.y - a.y + b.y}}}});
}

/// The black squares of a board; of each row those that stand together are none.
void add_squares(Shapes& shapes, GridSize size, double square_mm) {
    for (int row = 0; row < size.rows; ++row) {
        for (int column = row % 2; column < size.columns; column += 2) {
            const double x = (column - 0.5 * size.columns) * square_mm;
            const double y = (row - 0.5 * size.rows) * square_mm;
            add_rectangle(shapes, {x, y}, {x + square_mm, y + square_mm});
        }
    }
}

void add_pattern(Shapes& shapes, const Chart&, const Checkerboard& board) {
    add_squares(shapes, {board.columns, board.rows}, board.square_mm);
}

void add_pattern(Shapes& shapes, const Chart& chart, const DiscGrid& grid) {
    for (const Vec2d& centre : feature_points(chart)) {
        shapes.push_back({OutlineDisc{centre, 0.5 * grid.diameter_mm}});
    }
}

void add_pattern(Shapes&, const Chart&, const FlatField&) {}

/// A marker: its black square, and white cells upon it, those that stand side by side in one piece.
void add_marker(Shapes& shapes, const CharucoBoard& board, std::uint64_t marker, const Vec2d& centre) {
    const double half = 0.5 * board.marker_mm;
    const double cell = board.marker_mm / (board.cells + 2);
    add_rectangle(shapes, {centre.x - half, centre.y - half}, {centre.x + half, centre.y + half});
    const auto is_white = [&](int column, int row) {
        return (marker >> (board.cells * board.cells - 1 - (row * board.cells + column)) & 1U) != 0;
    };
    for (int row = 0; row < board.cells; ++row) {
        for (int column = 0; column < board.cells; ++column) {
            const int first = column;
            while (column < board.cells && is_white(column, row)) {
                ++column;
            }
            if (column > first) {
                const double y = centre.y - half + (row + 1) * cell;
                add_rectangle(shapes, {centre.x - half + (first + 1) * cell, y},
                              {centre.x - half + (column + 1) * cell, y + cell}, false);
            }
        }
    }
}

void add_pattern(Shapes& shapes, const Chart&, const CharucoBoard& board) {
    add_squares(shapes, {board.columns, board.rows}, board.square_mm);
    std::size_t next = 0;
    for (int row = 0; row < board.rows; ++row) {
        for (int column = (row + 1) % 2; column < board.columns; column += 2) {
            const Vec2d centre{(column + 0.5 - 0.5 * board.columns) * board.square_mm,
                               (row + 0.5 - 0.5 * board.rows) * board.square_mm};
            add_marker(shapes, board, board.markers[next++], centre);
        }
    }
}

void add_pattern(Shapes& shapes, const Chart&, const SiemensStar& star) {
    const double sector = 2.0 * std::numbers::pi / star.sectors;
    for (int i = 0; i < star.sectors; i += 2) {
        shapes.push_back({OutlineSector{star.radius_mm, i * sector, (i + 1) * sector}});
    }
}

void add_pattern(Shapes& shapes, const Chart& chart, const SlantedEdges& edges) {
    const double angle = edges.angle_deg * std::numbers::pi / 180.0;
    for (const Vec2d& centre : feature_points(chart)) {
        add_turned(shapes, centre, {std::cos(angle), std::sin(angle)}, edges.square_mm, edges.square_mm);
    }
}

void add_pattern(Shapes& shapes, const Chart& chart, const PointGrid& grid) {
    const Vec2d size = pattern_size_mm(chart);
    add_rectangle(shapes, {-0.5 * size.x, -0.5 * size.y}, {0.5 * size.x, 0.5 * size.y});
    for (const Vec2d& centre : feature_points(chart)) {
        shapes.push_back({OutlineDisc{centre, 0.5 * grid.dot_mm}, false});
    }
}

void add_pattern(Shapes& shapes, const Chart& chart, const AstigmatismCrosses& crosses) {
    for (const Vec2d& centre : feature_points(chart)) {
        const double radius = std::hypot(centre.x, centre.y);
        const Vec2d along = radius > 0.0 ? Vec2d{centre.x / radius, centre.y / radius} : Vec2d{1.0, 0.0};
        add_turned(shapes, centre, along, crosses.length_mm, crosses.line_mm);
        add_turned(shapes, centre, along, crosses.line_mm, crosses.length_mm);
    }
}

void add_pattern(Shapes& shapes, const Chart& chart, const ColourChecker& checker) {
    const Vec2d size = pattern_size_mm(chart);
    const double half = 0.5 * checker.patch_mm;
    add_rectangle(shapes, {-0.5 * size.x, -0.5 * size.y}, {0.5 * size.x, 0.5 * size.y});
    for (const Vec2d& centre : feature_points(chart)) {
        add_rectangle(shapes, {centre.x - half, centre.y - half}, {centre.x + half, centre.y + half}, false);
    }
}

void add_pattern(Shapes& shapes, const Chart& chart, const StraightLines& lines) {
    const Vec2d size = pattern_size_mm(chart);
    const double half = 0.5 * lines.line_mm;
    for (int column = 0; column < lines.columns; ++column) {
        const double x = (column - 0.5 * (lines.columns - 1)) * lines.pitch_mm;
        add_rectangle(shapes, {x - half, -0.5 * size.y}, {x + half, 0.5 * size.y});
    }
    for (int row = 0; row < lines.rows; ++row) {
        const double y = (row - 0.5 * (lines.rows - 1)) * lines.pitch_mm;
        add_rectangle(shapes, {-0.5 * size.x, y - half}, {0.5 * size.x, y + half});
    }
}

}  // namespace

std::vector<OutlineShape> chart_outline(const Chart& chart) {
    Shapes shapes;
    std::visit([&](const auto& pattern) { add_pattern(shapes, chart, pattern); }, chart.pattern);
    return shapes;
}

}  // namespace lensproof::scene
