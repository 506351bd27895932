// engine/scene/chart/straight_lines.h — a grid of lines: what is straight here and bent in a picture, the lens bent.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/base/kinds.h"
#include "engine/scene/chart/chart_traits.h"
#include "engine/scene/chart/outline.h"

namespace lensproof::scene {

/// Black lines of width `line_mm`, `columns` from top to bottom and `rows` across, `pitch_mm` apart, each of which goes
/// on for half a pitch beyond the outermost that it crosses.
struct StraightLines {
    static constexpr KindNames<> kNames{"straight-lines"};
    int columns = 0;
    int rows = 0;
    double pitch_mm = 0.0;
    double line_mm = 0.0;
};

void visit_keys(StraightLines& lines, auto& keys) {
    keys.grid("lines", lines.columns, lines.rows, {.least = 2, .printed = {13, 9}});
    keys.pitch("pitch_mm", lines.pitch_mm, {lines.columns, lines.rows});
    keys.part("line_mm", lines.line_mm,
              {.of = "pitch_mm", .most_mm = lines.pitch_mm, .printed_mm = 0.06 * lines.pitch_mm});
}

inline bool is_black(const StraightLines& lines, double x_mm, double y_mm) {
    const Cell cell = cell_at({lines.columns, lines.rows}, lines.pitch_mm, x_mm, y_mm);
    const double half_line = 0.5 * lines.line_mm / lines.pitch_mm;
    return cell.is_on_grid && (std::abs(cell.x) < half_line || std::abs(cell.y) < half_line);
}

inline ChartTraits traits(const StraightLines& lines) {
    return {.points = {lines.columns, lines.rows},
            .pitch_mm = lines.pitch_mm,
            .size_mm = {lines.columns * lines.pitch_mm, lines.rows * lines.pitch_mm},
            .look = LineCrossings{.line_pitches = lines.line_mm / lines.pitch_mm},
            .narrowest_mm = std::min(lines.line_mm, lines.pitch_mm - lines.line_mm)};
}

inline Outline outline(const StraightLines& lines) {
    Outline outline;
    const Vec2d size = traits(lines).size_mm;
    const double half = 0.5 * lines.line_mm;
    for (int column = 0; column < lines.columns; ++column) {
        const double x = (column - 0.5 * (lines.columns - 1)) * lines.pitch_mm;
        outline.push_back(rectangle({x - half, -0.5 * size.y}, {x + half, 0.5 * size.y}));
    }
    for (int row = 0; row < lines.rows; ++row) {
        const double y = (row - 0.5 * (lines.rows - 1)) * lines.pitch_mm;
        outline.push_back(rectangle({-0.5 * size.x, y - half}, {0.5 * size.x, y + half}));
    }
    return outline;
}

}  // namespace lensproof::scene
