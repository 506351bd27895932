// engine/scene/chart_outline.h — a chart's shapes, to draw it with.
#pragma once
#include <variant>
#include <vector>

#include "engine/scene/chart.h"

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

/// The shapes that make up a chart, in the order in which to fill them on white. `is_black` (chart.h) is what they
/// have to look like; tests/experiments/draw/print/chart_print_test.cpp holds the two together. None for a flat field.
std::vector<OutlineShape> chart_outline(const Chart& chart);

}  // namespace lensproof::scene
