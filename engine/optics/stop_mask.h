// engine/optics/stop_mask.h — what a stop that is no full circle lets through.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/base/infinity.h"
#include "engine/base/vec.h"
#include "engine/optics/prescription.h"
#include "engine/optics/texture_edges.h"

namespace lensproof::optics {

/// What a StopMask says, as plain arrays of someone else's: what every tracer asks, on a GPU too. In units of the
/// semi-diameter.
struct StopOpening {
    /// An edge of the polygon: the disc (curved blade) or half plane (straight) that it bounds.
    struct Edge {
        double x = 0.0;  // towards the middle of the edge, a unit vector
        double y = 0.0;
        double centre = 0.0;          // along it, of the disc
        double radius_squared = 0.0;  // of the disc; 0: the half plane up to `centre`

        [[nodiscard]] constexpr double margin(double at_x, double at_y) const {  // ≤ 0 inside
            const double along = x * at_x + y * at_y - centre;
            const double across = x * at_y - y * at_x;
            return radius_squared > 0.0 ? along * along + across * across - radius_squared : along;
        }
        [[nodiscard]] double radius() const;  // infinite where it is straight
    };

    std::span<const Edge> edges;
    std::span<const float> texture;  // row by row from the top; empty: none
    int texture_columns = 0;
    int texture_rows = 0;

    [[nodiscard]] constexpr bool is_full_circle() const { return edges.empty() && texture.empty(); }

    /// The transmittance, 0 to 1, at a point inside the unit circle.
    [[nodiscard]] constexpr double transmittance(double x, double y) const {
        for (const Edge& edge : edges) {
            if (!(edge.margin(x, y) <= 0.0)) {
                return 0.0;
            }
        }
        return texture.empty() ? 1.0 : texture[texture_place(x, y, texture_columns, texture_rows)];
    }

    /// How far a point stands inside (≤ 0) or outside (> 0) the blade's edge that is nearest to being crossed, and
    /// which that is, from 0: smooth along each edge. A texture has no edges but where it is dark: an infinite margin
    /// there, −1 elsewhere.
    struct EdgeMargin {
        double margin = -1.0;
        int edge = 0;
    };
    [[nodiscard]] constexpr EdgeMargin edge_margin(double x, double y) const {
        if (!texture.empty()) {
            return {transmittance(x, y) > 0.0 ? -1.0 : kInfinity, 0};
        }
        EdgeMargin worst;
        for (std::size_t i = 0; i < edges.size(); ++i) {
            const double margin = edges[i].margin(x, y);
            if (i == 0 || margin > worst.margin) {
                worst = {margin, static_cast<int>(i)};
            }
        }
        return worst;
    }
};

/// The part of a stop's circle that is open, at a given semi-diameter.
class StopMask {
  public:
    using Edge = StopOpening::Edge;

    /// The full circle.
    StopMask() = default;

    /// Throws InputError naming a texture's picture that was not read.
    explicit StopMask(const StopShape& shape);

    [[nodiscard]] bool is_full_circle() const { return edges_.empty() && !texture_; }

    /// The same as plain arrays, which are this mask's.
    [[nodiscard]] StopOpening opening() const;

    /// The transmittance, 0 to 1, at a point of the stop's plane in units of its semi-diameter, inside the unit circle.
    [[nodiscard]] double transmittance(double x, double y) const { return opening().transmittance(x, y); }

    [[nodiscard]] StopOpening::EdgeMargin edge_margin(double x, double y) const { return opening().edge_margin(x, y); }

    /// A point's place beside an edge of the opening, in units of the semi-diameter.
    struct NearEdge {
        double distance = 0.0;  // to its foot on the edge
        Vec2d outward;          // of unit length, from the point to the foot
        double radius = 0.0;    // of the edge; infinite where it is straight, negative where it bulges inwards
        double length = 0.0;    // of the edge from corner to corner; infinite of what has no corners
    };

    /// The edges, of the circle too, that have their foot from a point of the opening between their ends and within
    /// `width`: beside a corner two of them.
    [[nodiscard]] std::vector<NearEdge> edges_near(double x, double y, double width) const;

    /// A point of the edges, the circle's too, in units of the semi-diameter.
    struct EdgePoint {
        Vec2d point;
        Vec2d outward;        // across the edge, of unit length
        double length = 0.0;  // of the edge, as above
    };

    /// The point at this fraction of the edges' length: even fractions lie evenly along them. Not without edges.
    [[nodiscard]] EdgePoint edge_at(double fraction) const;

    /// The same mask, which knows the edges of its texture too: they are looked for (texture_edges.h).
    [[nodiscard]] StopMask with_edges() const;

    /// Whether it knows edges: a soft texture has none.
    [[nodiscard]] bool has_edges() const { return !texture_ || pieces_; }

    /// The edges' length and what they enclose, in units of the semi-diameter. Not without edges.
    [[nodiscard]] double perimeter() const;
    [[nodiscard]] double area() const;

    /// Appends all that tells this mask from another.
    void append_to(std::string& bytes) const;

  private:
    // Of a circle or blades.
    [[nodiscard]] double half_chord() const;
    [[nodiscard]] double edge_length() const;

    std::vector<Edge> edges_;
    std::shared_ptr<const ApertureTexture> texture_;
    std::shared_ptr<const std::vector<EdgePiece>> pieces_;  // of its edges
};

}  // namespace lensproof::optics
