// engine/optics/region_outline.h — the outline of a plane region that several limits bound together, and its area.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "engine/optics/vec.h"

namespace lensproof {

/// How a point stands to a region.
struct RegionSample {
    double margin = 0.0;  // ≤ 0 inside; > 0 outside: smooth along one limit, infinite where nothing is known but that
    int limit = -1;       // the limit that comes first in the way: the one with the largest margin
};

using Region = std::function<RegionSample(Vec2d)>;

/// A point of the outline, and the wedge that it stands for.
struct OutlinePoint {
    Vec2d edge;         // from the outline's centre to the point
    double wedge_area;  // ∫ over the region is Σ wedge_area · 2 ∫₀¹ f(centre + t · edge) t dt
    int limit = -1;     // which limit the region ends at
};

/// The outline of a region seen from a point inside it, in order of rising azimuth (from +x towards +y), as quadrature
/// points: between the corners, where one limit takes over from another, they are Gauss-Kronrod nodes in azimuth, so
/// that the area converges as that of a smooth curve does.
///
/// The region has to be star-shaped about some point: each ray from there leaves it once. Of what lies beyond the first
/// exit (the far part of an annulus) nothing is seen. `is_star_shaped` is false where points between the centre and the
/// outline lie outside, or the area does not converge because the outline jumps; the area is then not to be trusted.
struct RegionOutline {
    Vec2d centre;
    bool is_half = false;  // the points with x ≥ 0 alone stand for the whole region, which is their mirror image too
    std::vector<OutlinePoint> points;  // empty: nothing is inside
    double area = 0.0;                 // of the whole region
    double relative_error = 0.0;       // estimated, of the area
    bool is_star_shaped = true;

    [[nodiscard]] bool is_empty() const { return points.empty(); }
};

/// Where to look for a region.
struct RegionSearch {
    Vec2d start;             // probably inside
    double reach = 1.0;      // no point of the region lies farther from `start`
    bool is_mirror = false;  // the region is its own mirror image in x = 0, and start.x = 0
};

/// A point inside: `start`, or else the best of a grid, improved by compass search down the margin (Kolda, Lewis,
/// Torczon, SIAM Review 45, 2003); of a mirror image, on x = 0. Nothing where none is found.
std::optional<Vec2d> find_inside(const Region& region, const RegionSearch& search);

/// Where a region is left on the way from a point inside it.
struct RegionEdge {
    double distance = 0.0;  // in units of `along`, the last one inside to 1e-14
    int limit = -1;
};

/// The way goes from `inside` along the vector `along`; the edge is expected at about `hint` times it. Found between
/// points inside and outside by TOMS 748 (Alefeld, Potra, Shi 1995), or by halving where the margin is infinite.
RegionEdge region_edge(const Region& region, Vec2d inside, Vec2d along, double hint = 1.0);

/// The outline about a point near the middle of the region, or between there and its edge where it is not star-shaped
/// about the middle (a crescent). Pieces are halved until the estimate of the area's error
/// (Piessens et al., QUADPACK 1983) is below 1e-11.
RegionOutline region_outline(const Region& region, const RegionSearch& search);

/// A point of a region and the area that it stands for.
struct RegionNode {
    Vec2d point;
    double weight;
};

/// Nodes over the whole region: `rings` Gauss-Legendre nodes along each point of the outline. The weights are positive
/// and add up to the area; polynomials up to degree 2 rings − 2 along each are integrated exactly.
std::vector<RegionNode> region_quadrature(const RegionOutline& outline, int rings);

/// Gauss-Legendre nodes and weights on [0, 1], ascending.
struct GaussRule {
    std::vector<double> nodes;
    std::vector<double> weights;
};
GaussRule gauss_legendre(int count);

}  // namespace lensproof
