// engine/optics/texture_edges.h — the edges of a stop that a picture describes: where it turns from bright to dark.
#pragma once
#include <optional>
#include <vector>

#include "engine/optics/prescription.h"

namespace lensproof::optics {

/// A piece of an edge, in units of the stop's semi-diameter, between two points of it.
struct EdgePiece {
    Vec2d from;
    Vec2d to;
    Vec2d outward_from;  // towards the dark, of unit length
    Vec2d outward_to;
    double edge_length = 0.0;  // of the straight edge that it is; infinite of a curve
    double before = 0.0;       // the length of all pieces before it

    /// At a fraction of its length.
    [[nodiscard]] Vec2d outward(double fraction) const;
    [[nodiscard]] double piece_length() const { return length(to - from); }
};

/// The contours of half brightness, the stop's circle being dark outside (marching squares; Lorensen and Cline,
/// SIGGRAPH 1987), each as a polygon that stays within 0.6 texels of it (Ramer 1972; Douglas and Peucker 1973). A side
/// longer than any of a curve of twice the stop's radius is a straight edge, with its contour's points about which way
/// it runs, and swallows what is left of it beside corners that texels have rounded off; others are parts of curves,
/// whose normal turns between the corners' unless a corner is sharper than 25°.
///
/// Nothing where the picture has no edges: where somewhere from three texels inside a contour to three outside it does
/// not go from nine tenths of full brightness and more to one tenth and less.
std::optional<std::vector<EdgePiece>> texture_edges(const ApertureTexture& texture);

}  // namespace lensproof::optics
