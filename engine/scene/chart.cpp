#include "engine/scene/chart.h"

namespace lensproof {

namespace {

/// Calls the overload that fits the pattern.
template <class... Fs>
struct Overloaded : Fs... {
    using Fs::operator()...;
};
template <class... Fs>
Overloaded(Fs...) -> Overloaded<Fs...>;  // clang before 17 does not deduce it for an aggregate

// Called for every camera path: whole numbers by conversion, which needs no function call on any machine, and no root.

bool is_black(const Checkerboard& board, double x_mm, double y_mm) {
    const double x = x_mm / board.square_mm + 0.5 * board.columns;
    const double y = y_mm / board.square_mm + 0.5 * board.rows;
    const bool on_board = x >= 0.0 && x < board.columns && y >= 0.0 && y < board.rows;
    return on_board && (static_cast<int>(x) + static_cast<int>(y)) % 2 == 0;
}

bool is_black(const DiscGrid& grid, double x_mm, double y_mm) {
    // In cells of one pitch, each with its disc in the middle.
    const double x = x_mm / grid.pitch_mm + 0.5 * grid.columns;
    const double y = y_mm / grid.pitch_mm + 0.5 * grid.rows;
    if (!(x >= 0.0 && x < grid.columns && y >= 0.0 && y < grid.rows)) {
        return false;
    }
    const double from_middle_x = x - static_cast<int>(x) - 0.5;
    const double from_middle_y = y - static_cast<int>(y) - 0.5;
    const double radius = 0.5 * grid.diameter_mm / grid.pitch_mm;
    return from_middle_x * from_middle_x + from_middle_y * from_middle_y < radius * radius;
}

bool is_black(const FlatField&, double, double) {
    return false;
}

double feature_pitch_mm(const Chart& chart) {
    return std::visit(
        Overloaded{[](const Checkerboard& board) { return board.square_mm; },
                   [](const DiscGrid& grid) { return grid.pitch_mm; }, [](const FlatField&) { return 0.0; }},
        chart.pattern);
}

}  // namespace

double reflectance(const Chart& chart, double x_mm, double y_mm) {
    const bool black = std::visit([&](const auto& pattern) { return is_black(pattern, x_mm, y_mm); }, chart.pattern);
    return black ? chart.black_reflectance : chart.white_reflectance;
}

GridSize feature_grid(const Chart& chart) {
    return std::visit(Overloaded{[](const Checkerboard& board) {
                                     return GridSize{board.columns - 1, board.rows - 1};
                                 },
                                 [](const DiscGrid& grid) {
                                     return GridSize{grid.columns, grid.rows};
                                 },
                                 [](const FlatField&) { return GridSize{}; }},
                      chart.pattern);
}

std::vector<Vec2d> feature_points(const Chart& chart) {
    const GridSize size = feature_grid(chart);
    const double pitch = feature_pitch_mm(chart);
    std::vector<Vec2d> points;
    for (int row = 0; row < size.rows; ++row) {
        for (int column = 0; column < size.columns; ++column) {
            points.push_back({(column - 0.5 * (size.columns - 1)) * pitch, (row - 0.5 * (size.rows - 1)) * pitch});
        }
    }
    return points;
}

std::string kind_name(const Chart& chart) {
    return std::visit(
        Overloaded{[](const Checkerboard&) { return "checkerboard"; }, [](const DiscGrid&) { return "disc-grid"; },
                   [](const FlatField&) { return "flat-field"; }},
        chart.pattern);
}

}  // namespace lensproof
