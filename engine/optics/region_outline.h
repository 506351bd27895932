// engine/optics/region_outline.h — the outline of a plane region that several limits bound together, and its area.
#pragma once
#include <vector>

#include "engine/optics/region.h"

namespace lensproof::optics {

/// A point of the outline, and the wedge that it stands for.
struct OutlinePoint {
    Vec2d edge;         // from the outline's centre to the point, unbent
    double wedge_area;  // ∫ over the region is Σ wedge_area · 2 ∫₀¹ f(at(point, t)) t dt
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
    double bend = 0.0;                 // 1 / length: the wedges' own plane is sheared by (0, bend · x²)
    double area = 0.0;                 // of the whole region
    double relative_error = 0.0;       // estimated, of the area
    bool is_star_shaped = true;

    [[nodiscard]] bool is_empty() const { return points.empty(); }

    /// The point at the fraction `t` of the distance from the centre to a point of the outline; with t = 1 that point
    /// itself.
    [[nodiscard]] Vec2d at(const OutlinePoint& point, double t) const {
        const double x = t * point.edge.x;
        return {centre.x + x, centre.y + t * point.edge.y + bend * x * x};
    }
};

/// The outline about a point near the middle of the region, or between there and its edge where it is not star-shaped
/// about the middle (a crescent). The last light of a fisheye is a long, bent strip, star-shaped about no point: it is
/// straightened by a shear across x, which keeps areas. Pieces are halved until the estimate of the area's error
/// (Piessens et al., QUADPACK 1983) is below 1e-11, or no more than the rounding of the region's numbers.
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

}  // namespace lensproof::optics
