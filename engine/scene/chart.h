// engine/scene/chart.h — flat test charts, analytic, so that their edges are exact at every scale.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/base/vec.h"

namespace lensproof::scene {

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

/// A checkerboard with an ArUco marker in the middle of each white square, the first at the top, numbered row by row
/// (OpenCV's `CharucoBoard` of version 4.7 and later, without its legacy pattern).
struct CharucoBoard {
    int columns = 0;
    int rows = 0;
    double square_mm = 0.0;
    double marker_mm = 0.0;              // with the marker's own black border, one cell wide
    int cells = 0;                       // of a marker's pattern, along a side: 4, 5 or 6
    std::vector<std::uint64_t> markers;  // by number: cells row by row from the top left, white 1, the last one lowest
};

/// `sectors` sectors of equal angle, black and white in turn; the first black one begins at +x and runs towards +y.
struct SiemensStar {
    int sectors = 0;  // even: twice the line pairs on a circle
    double radius_mm = 0.0;
};

/// Black squares, each turned by `angle_deg` about its centre (clockwise as one sees the chart), whose edges measure
/// resolution (ISO 12233).
struct SlantedEdges {
    int columns = 0;
    int rows = 0;
    double pitch_mm = 0.0;
    double square_mm = 0.0;
    double angle_deg = 5.0;
};

/// White dots of diameter `dot_mm` on black cells of side `pitch_mm`, each in the middle of its cell.
struct PointGrid {
    int columns = 0;
    int rows = 0;
    double pitch_mm = 0.0;
    double dot_mm = 0.0;
};

/// Black crosses, each of a line along the radius from the chart's centre and one at right angles to it: the two focus
/// apart where there is astigmatism. At the centre itself, the lines run along x and y.
struct AstigmatismCrosses {
    int columns = 0;
    int rows = 0;
    double pitch_mm = 0.0;
    double length_mm = 0.0;  // of a line, and
    double line_mm = 0.0;    // its width
};

/// Black lines of width `line_mm`, `columns` from top to bottom and `rows` across, `pitch_mm` apart, each of which goes
/// on for half a pitch beyond the outermost that it crosses: what is straight here and bent in a picture, the lens
/// bent.
struct StraightLines {
    int columns = 0;
    int rows = 0;
    double pitch_mm = 0.0;
    double line_mm = 0.0;
};

/// The 6 × 4 patches of a colour checker, `gap_mm` apart and as far from the card's edge. What the patches reflect
/// texture.h knows; here they are white, on black.
struct ColourChecker {
    double patch_mm = 0.0;
    double gap_mm = 0.0;

    static constexpr int kColumns = 6;
    static constexpr int kRows = 4;
};

using ChartPattern = std::variant<Checkerboard, DiscGrid, FlatField, CharucoBoard, SiemensStar, SlantedEdges, PointGrid,
                                  AstigmatismCrosses, ColourChecker, StraightLines>;

/// A flat chart in its own plane: origin at its centre, x to the right, y down as a camera that faces it sees it, mm.
/// Around the pattern lies white without end, so that a frame that looks past the chart stays defined.
struct Chart {
    ChartPattern pattern;
    double white_reflectance = 0.9;
    double black_reflectance = 0.04;
};

/// Whether (x, y) mm is black, not white.
bool is_black(const Chart& chart, double x_mm, double y_mm);

/// Lambertian reflectance at (x, y) mm.
double reflectance(const Chart& chart, double x_mm, double y_mm);

/// The colour checker's patch at (x, y) mm, row by row from 0 at the top left (a ColorChecker's "dark skin"); nothing
/// between patches, and on any other chart.
std::optional<int> patch_index(const Chart& chart, double x_mm, double y_mm);

/// The chart's points, row by row from the top left; mm: inner corners of a checkerboard or a ChArUco board; centres of
/// discs, squares, dots, crosses or patches; where straight lines cross; the star's centre. None on a flat field.
std::vector<Vec2d> feature_points(const Chart& chart);

/// Columns and rows of `feature_points`; {0, 0} on a flat field.
struct GridSize {
    int columns = 0;
    int rows = 0;
};
GridSize feature_grid(const Chart& chart);

/// Width and height of what is not the endless white; {0, 0} of a flat field.
Vec2d pattern_size_mm(const Chart& chart);

/// The kind's name in files: "checkerboard", "disc-grid", "flat-field", "charuco", "siemens-star", "slanted-edges",
/// "point-grid", "astigmatism-crosses", "colour-checker" or "straight-lines".
std::string kind_name(const Chart& chart);

}  // namespace lensproof::scene
