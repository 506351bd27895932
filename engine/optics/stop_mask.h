// engine/optics/stop_mask.h — what a stop that is no full circle lets through.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "engine/base/vec.h"
#include "engine/optics/prescription.h"

namespace lensproof::optics {

/// The part of a stop's circle that is open, at a given semi-diameter.
class StopMask {
  public:
    /// The full circle.
    StopMask() = default;

    /// Throws InputError naming a texture's picture that was not read.
    explicit StopMask(const StopShape& shape);

    [[nodiscard]] bool is_full_circle() const { return arcs_.empty() && !texture_; }

    /// The transmittance, 0 to 1, at a point of the stop's plane in units of its semi-diameter, inside the unit circle.
    [[nodiscard]] double transmittance(double x, double y) const;

    /// How far a point stands inside (≤ 0) or outside (> 0) the blade's edge that is nearest to being crossed, and
    /// which that is, from 0: smooth along each edge. A texture has no edges but where it is dark: an infinite margin
    /// there, −1 elsewhere.
    struct EdgeMargin {
        double margin = -1.0;
        int edge = 0;
    };
    [[nodiscard]] EdgeMargin edge_margin(double x, double y) const;

    /// A point's place beside an edge of the opening, in units of the semi-diameter.
    struct NearEdge {
        double distance = 0.0;  // to its foot on the edge
        Vec2d outward;          // of unit length, from the point to the foot
        double radius = 0.0;    // of the edge; infinite where it is straight
    };

    /// The edges, of the circle too, that have their foot from a point of the opening between their ends and within
    /// `width`: beside a corner two of them. None of a texture.
    [[nodiscard]] std::vector<NearEdge> edges_near(double x, double y, double width) const;

    /// A point of the edges, the circle's too, in units of the semi-diameter.
    struct EdgePoint {
        Vec2d point;
        Vec2d outward;  // across the edge, of unit length
    };

    /// The point at this share, 0 to 1, of the edges' length: even shares lie evenly along them. Not of a texture.
    [[nodiscard]] EdgePoint edge_at(double share) const;

    /// Whether it has edges: a texture has none.
    [[nodiscard]] bool has_edges() const { return !texture_; }

    /// The length of an edge from corner to corner, in units of the semi-diameter: infinite for the circle, which has
    /// no corners. Not of a texture.
    [[nodiscard]] double edge_length() const;

    /// The edges' length and what they enclose, in units of the semi-diameter. Not of a texture.
    [[nodiscard]] double perimeter() const;
    [[nodiscard]] double area() const;

    /// Appends all that tells this mask from another.
    void append_to(std::string& bytes) const;

  private:
    /// An edge of the polygon: the disc (curved blade) or half plane (straight) that it bounds.
    struct Arc {
        double x = 0.0;  // towards the middle of the edge, a unit vector
        double y = 0.0;
        double centre = 0.0;          // along it, of the disc
        double radius_squared = 0.0;  // of the disc; 0: the half plane up to `centre`

        [[nodiscard]] double margin(double at_x, double at_y) const;  // ≤ 0 inside
        [[nodiscard]] double radius() const;                          // infinite where it is straight
    };

    [[nodiscard]] double half_chord() const;  // of each edge

    std::vector<Arc> arcs_;
    std::shared_ptr<const StopTexture> texture_;
};

}  // namespace lensproof::optics
