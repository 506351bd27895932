// engine/analysis/ghost_light.h — how much of a distant light's energy a ghost lays on the sensor, and where.
#pragma once
#include <cstdint>
#include <vector>

#include "engine/analysis/ghost_region.h"

namespace lensproof::analysis {

/// Energy over the square around the image circle, in pixels, for the irradiance at the brightest place.
class Footprint {
  public:
    static constexpr int kPixels = 512;

    explicit Footprint(double radius);

    /// Adds energy spread evenly over the parallelogram of `u` and `v` about `centre`: where the map from the front
    /// element to the sensor folds and its Jacobian vanishes, what is added stays finite.
    void add(Vec2d centre, Vec2d u, Vec2d v, double energy);
    void clear();

    /// The side of the square over which the peak irradiance is a mean, mm: 1 / 171 of the image circle's diameter.
    [[nodiscard]] double patch() const { return 3.0 * pixel_; }
    /// The largest mean irradiance over such a square, 1/mm² of the light that enters the entrance pupil.
    [[nodiscard]] double peak() const;
    /// Energy a pixel, rows from low y.
    [[nodiscard]] const std::vector<double>& pixels() const { return pixels_; }

  private:
    void add_point(Vec2d at, double energy);

    double radius_;
    double pixel_;
    std::vector<double> pixels_;
};

struct GhostSampling {
    int rays = 16000;  // about so many, in eight grids
    std::uint64_t seed = 0;
};

/// A ray of the first grid that landed.
struct LandedRay {
    Vec2d offset;
    Vec2d point;
    double energy;
};

/// Energies are fractions of the light that enters the entrance pupil.
struct GhostLight {
    double energy = 0.0;
    double standard_error = 0.0;
    Vec2d centroid{};         // mm; of no meaning without energy, as is the radius
    double rms_radius = 0.0;  // about the centroid, mm
    double peak = 0.0;        // Footprint::peak; 0 without a footprint
    int rays = 0;
    int landed = 0;
    std::vector<LandedRay> first_grid;
};

/// Eight grids over the region, each shifted at random as a whole (Cranley & Patterson 1976): their mean is the energy,
/// and how they differ its standard error. One ray in thirty goes to the rest of the front element at random, so that
/// light which the region misses counts too, if it is found. `footprint`, which may be null, is that of the first grid
/// alone, since it costs more than all grids' rays; it is cleared first.
GhostLight measure_ghost(const GhostScene& scene, const optics::GhostPath& path, const GhostRegion& region,
                         const GhostSampling& sampling, Footprint* footprint = nullptr);

}  // namespace lensproof::analysis
