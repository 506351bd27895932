// engine/analysis/spot.h — where the rays of an object point meet the sensor: spot diagrams and their sizes.
#pragma once
#include <span>
#include <vector>

#include "engine/analysis/beam_outline.h"

namespace lensproof::analysis {

/// A ray at the image.
struct SpotRay {
    Vec2d point;    // where it meets the sensor's plane, mm
    Vec2d slope;    // dx/dz, dy/dz: at a plane z behind it, the ray is at point + z · slope
    double weight;  // mm² of the incoming beam's cross-section; 0 for a ray on the outline, which only bounds the spot

    [[nodiscard]] Vec2d at(double defocus_mm) const { return point + defocus_mm * slope; }
};

/// Rings with which the rms of a camera lens's spot has converged to 1e-9 mm (its square is a polynomial of degree 20
/// or so in the offset).
inline constexpr int kSpotRings = 12;

/// The bundle's rays at the nodes of `region_quadrature`, for sums, and those along its outline, with weight 0. Sums
/// over them converge with the number of rings as those of smooth functions do.
std::vector<SpotRay> spot_rays(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle,
                               const optics::RegionOutline& outline, int rings = kSpotRings);

/// The rays at the centres of a grid of `cells`² squares, ±`half_width` mm about the chief ray, that pass every rim: of
/// equal weight, for spot diagrams as they are usually drawn. Sums over them are good to about 1 / cells.
std::vector<SpotRay> spot_grid(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle,
                               double half_width, int cells);

/// Several wavelengths' spots as one: each ray's weight times that of its wavelength.
std::vector<SpotRay> pooled(std::span<const std::vector<SpotRay>> spots, std::span<const double> spectral_weights);

struct SpotSize {
    Vec2d centroid;           // mm, in the plane of the defocus
    double rms = 0.0;         // mm: root mean square distance from the centroid, by area of the beam's cross-section
    double max_radius = 0.0;  // mm: the farthest ray from the centroid
};

/// At the plane `defocus_mm` behind the sensor's. No light, no size: all zero.
SpotSize spot_size(std::span<const SpotRay> rays, double defocus_mm = 0.0);

}  // namespace lensproof::analysis
