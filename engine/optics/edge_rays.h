// engine/optics/edge_rays.h — rays that the edge of a stop diffracts, in the place of rays that pass close to it.
#pragma once
#include <array>
#include <optional>

#include "engine/base/ray.h"
#include "engine/optics/stop_mask.h"

namespace lensproof::optics {

/// Deflections about an edge, to either side, radians. Below the smallest, light counts as going straight on.
struct DeflectionRange {
    double smallest = 0.0;
    double largest = 0.0;
};

/// Which rays are diffracted, and how far.
struct EdgeZone {
    double width = 0.0;  // of the zone along the edges, in units of the stop's semi-diameter
    DeflectionRange deflections;
};

/// A ray that goes on from the stop in another direction, and the light that it carries of the one that arrived.
struct DiffractedRay {
    Vec3<double> direction;
    double weight = 0.0;
};

/// A stop's plane z = const as rays find it.
struct StopPlane {
    const StopMask* mask = nullptr;
    double semi_diameter = 0.0;  // mm
    double wavenumber = 0.0;     // 2π n / λ, 1/mm
};

/// An edge where a ray meets it, in the stop's plane z = const.
struct StopEdge {
    Vec2d outward;        // across it, towards the blade, of unit length
    double length = 0.0;  // from corner to corner, mm; infinite of a circle
};

/// A ray that an edge deflects, which a ray along `direction` meets, in the stop's frame. Its weight, mm: the light of
/// a mm of edge over that of a mm² of the plane. Deflections θ are drawn with a density of θ^(−3/2), between that of
/// the light, which leaves few rays far out, and one that is even in log θ. `wavenumber` k: 2π n / λ, 1/mm.
///
/// An endless edge has its rays on Keller's cone: sin θ across the edge, as good as straight on along it. One of length
/// ℓ spreads them along itself by sinc²(k sin θ s ℓ / 2), s the sine of the turn about the light's direction, which is
/// the wave of a straight edge by itself (Born and Wolf, §8.5.1; corners' interference is left out) and of a curved one
/// is narrower than the fan of its normals. What a deflection carries stays what Keller's coefficient says.
DiffractedRay diffracted_at_edge(const StopEdge& edge, double wavenumber, const Vec3<double>& direction,
                                 const DeflectionRange& deflections, const std::array<double, 2>& numbers);

/// What a ray becomes that passes the opening at `point` (from its middle, mm): with a probability that falls from 1 at
/// an edge to 0 at the zone's width, a ray on the Keller cone of that edge (Keller, J. Opt. Soc. Am. 52, 1962; drawn as
/// Steinert et al. 2011 do), turned as an edge of its length turns it. `numbers` are four from [0, 1). For rays that
/// fill the opening evenly the weights sum up to what the edges diffract by the geometrical theory, λ / (4π² θ²) of
/// what falls on a mm of edge into a radian at small angles θ: a zone estimates the light at its edge, so it is to be
/// narrow where the beam is uneven.
std::optional<DiffractedRay> diffracted(const StopPlane& stop, const EdgeZone& zone, const Vec2d& point,
                                        const Vec3<double>& direction, const std::array<double, 4>& numbers);

/// The fraction of the light through an evenly lit opening that its edges deflect by more than `angle` (small,
/// radians): P λ / (2π² A angle) with the opening's perimeter P and area A. What the light that goes straight on loses.
double diffracted_fraction(const StopPlane& stop, double angle);

}  // namespace lensproof::optics
