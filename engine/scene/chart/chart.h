// engine/scene/chart/chart.h — flat test charts, analytic, so that their edges are exact at every scale.
#pragma once
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "engine/scene/chart/astigmatism_crosses.h"
#include "engine/scene/chart/charuco_board.h"
#include "engine/scene/chart/checkerboard.h"
#include "engine/scene/chart/colour_checker.h"
#include "engine/scene/chart/disc_grid.h"
#include "engine/scene/chart/flat_field.h"
#include "engine/scene/chart/point_grid.h"
#include "engine/scene/chart/siemens_star.h"
#include "engine/scene/chart/slanted_edges.h"
#include "engine/scene/chart/straight_lines.h"

namespace lensproof::scene {

/// The kinds, each in a file of its own, which has besides what its numbers mean
///
///     kNames               what files call it; `kNotPrinted`: why it is not printed, where it is not
///     visit_keys           its keys in files (chart_keys.h)
///     is_black             whether (x, y) mm is black, not white
///     traits               its points, its size, and what may be measured on it (chart_traits.h)
///     outline              its shapes in the order in which to fill them on white, which have to look like `is_black`
///                          (tests/experiments/draw/print/chart_print_test.cpp holds the two together)
using ChartPattern = std::variant<Checkerboard, DiscGrid, FlatField, CharucoBoard, SiemensStar, SlantedEdges, PointGrid,
                                  AstigmatismCrosses, ColourChecker, StraightLines>;

/// A flat chart in its own plane: origin at its centre, x to the right, y down as a camera that faces it sees it, mm.
/// Around the pattern lies white without end, so that a frame that looks past the chart stays defined.
struct Chart {
    ChartPattern pattern;
    double white_reflectance = 0.9;
    double black_reflectance = 0.04;
};

/// As its kind has them.
bool is_black(const Chart& chart, double x_mm, double y_mm);
ChartTraits traits(const Chart& chart);
Outline outline(const Chart& chart);

/// Lambertian reflectance at (x, y) mm; and at many places, a column a coordinate.
double reflectance(const Chart& chart, double x_mm, double y_mm);
void reflectances(const Chart& chart, std::span<const double> x_mm, std::span<const double> y_mm,
                  std::span<double> reflectance);

/// The chart's points, row by row from the top left; mm: inner corners of a checkerboard or a ChArUco board; centres of
/// discs, squares, dots, crosses or patches; where straight lines cross; the star's centre. None on a flat field.
std::vector<Vec2d> feature_points(const Chart& chart);

/// Columns and rows of `feature_points`; {0, 0} on a flat field.
GridSize feature_grid(const Chart& chart);

/// Width and height of what is not the endless white; {0, 0} of a flat field.
Vec2d pattern_size_mm(const Chart& chart);

/// The kind's name in files: "checkerboard".
std::string kind_name(const Chart& chart);

/// A kind as lists name it.
struct ChartKind {
    std::string name;
    PointLook look;
    std::string not_printed;  // why it is not; empty where it may be printed
};

/// All kinds in the order of `PointLook`, then of their names.
std::vector<ChartKind> chart_kinds();

}  // namespace lensproof::scene
