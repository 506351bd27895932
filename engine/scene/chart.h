// engine/scene/chart.h — flat test charts, analytic, so that their edges are exact at every scale.
#pragma once
#include <string>
#include <variant>
#include <vector>

#include "engine/optics/vec.h"

namespace lensproof {

/// `columns` × `rows` squares of side `square_mm`; the square at the top left is black.
struct Checkerboard {
    int columns = 0;
    int rows = 0;
    double square_mm = 0.0;
};

/// Black discs of diameter `diameter_mm` whose centres stand `pitch_mm` apart.
struct DiscGrid {
    int columns = 0;
    int rows = 0;
    double pitch_mm = 0.0;
    double diameter_mm = 0.0;
};

/// One even tone without an edge.
struct FlatField {};

/// A flat chart in its own plane: origin at its centre, x to the right, y down as a camera that faces it sees it, mm.
/// Around the pattern lies white without end, so that a frame that looks past the chart stays defined.
struct Chart {
    std::variant<Checkerboard, DiscGrid, FlatField> pattern;
    double white_reflectance = 0.9;
    double black_reflectance = 0.04;
};

/// Lambertian reflectance at (x, y) mm.
double reflectance(const Chart& chart, double x_mm, double y_mm);

/// The points that a detector finds, row by row from the top left: inner corners, or disc centres; mm. None on a flat
/// field.
std::vector<Vec2d> feature_points(const Chart& chart);

/// Columns and rows of `feature_points`; {0, 0} on a flat field.
struct GridSize {
    int columns = 0;
    int rows = 0;
};
GridSize feature_grid(const Chart& chart);

/// The kind's name in files: "checkerboard", "disc-grid" or "flat-field".
std::string kind_name(const Chart& chart);

}  // namespace lensproof
