// engine/scene/chart/outline.h — a chart's shapes, to draw it with.
#pragma once
#include <variant>
#include <vector>

#include "engine/scene/chart/cells.h"

namespace lensproof::scene {

/// A polygon, closed; mm on the chart.
struct OutlinePolygon {
    std::vector<Vec2d> corners;
};

struct OutlineDisc {
    Vec2d centre;
    double radius_mm = 0.0;
};

/// A sector of a disc about the origin; angles from +x towards +y.
struct OutlineSector {
    double radius_mm = 0.0;
    double from_rad = 0.0;
    double to_rad = 0.0;
};

/// A shape in black or, upon what was drawn before it, in white.
struct OutlineShape {
    std::variant<OutlinePolygon, OutlineDisc, OutlineSector> shape;
    bool is_black = true;
};

using Outline = std::vector<OutlineShape>;

OutlineShape rectangle(const Vec2d& least, const Vec2d& most, bool is_black = true);
/// A rectangle about the origin.
OutlineShape rectangle(const Vec2d& size_mm);
/// A rectangle about `centre` of which two sides run along `along` (of length 1).
OutlineShape rectangle(const Vec2d& centre, const Vec2d& along, double length_mm, double width_mm);

/// The black squares of a board.
Outline board_squares(GridSize size, double square_mm);

}  // namespace lensproof::scene
