// engine/scene/chart/chart_traits.h — what is to be known of a chart besides where it is black: what a picture of it is
// searched for, and what may be measured on it.
#pragma once
#include <limits>
#include <variant>

#include "engine/scene/chart/cells.h"

namespace lensproof::scene {

// What a chart's points look like.

/// Corners at which four squares meet, two of them black; the first is the lower right one of a black square.
struct SquareCorners {};
/// The same with a marker in each white square, that stands so far (in squares) from its edges.
struct MarkedCorners {
    double clear_squares = 0.0;
};
/// Spots that stand alone, black or, `is_bright`, white on black.
struct Spots {
    const char* name = "";            // in messages: "discs"
    double radius_pitches = 0.0;      // of a circle that holds one
    double moment_diameter_mm = 0.0;  // of the disc that has its second moments
    bool is_bright = false;
};
/// Where black lines of this width cross.
struct LineCrossings {
    double line_pitches = 0.0;
};
/// What no picture is searched for; of these,
struct Unsearched {};
/// a Siemens star's centre,
struct StarCentre : Unsearched {};
/// and nothing: one even tone.
struct NoPoints : Unsearched {};

/// In the order in which messages list the kinds.
using PointLook = std::variant<SquareCorners, MarkedCorners, Spots, LineCrossings, Unsearched, StarCentre, NoPoints>;

// Straight edges between white and black.

struct NoEdges {};
/// The four sides of a black square about each point, turned by `angle_deg` (clockwise as one sees the chart).
struct SquareSides {
    double side_mm = 0.0;
    double angle_deg = 0.0;
};
/// From each point to the next in its row and its column, with even tones to this distance on either side.
struct CellSides {
    double even_mm = 0.0;
};

using Edges = std::variant<NoEdges, SquareSides, CellSides>;

/// Which of the cells between four points are white but for the points' own spots: none, all, or those of an odd
/// column + row.
enum class WhiteCells { none, all, odd };

struct ChartTraits {
    GridSize points;
    double pitch_mm = 0.0;  // between points
    Vec2d size_mm;          // of what is not the endless white; 0 of an even tone
    PointLook look = Unsearched();
    Edges edges = NoEdges();
    WhiteCells white = WhiteCells::none;
    double narrowest_mm = 0.0;  // that every white or black part is wide at least; 0 where none is stated
};

}  // namespace lensproof::scene
