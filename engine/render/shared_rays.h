// engine/render/shared_rays.h — what a path outside the lens counts at each of its wavelengths.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "engine/optics/packet/trace_batch.h"
#include "engine/pupil/pupil_slices.h"
#include "engine/render/camera_paths.h"
#include "engine/render/sampling/sensor.h"
#include "engine/spectral/spectral_sample.h"

namespace lensproof::render {

/// With which density a ray is drawn by paths that carry all of their wavelengths, and by those of the hero alone.
struct PathDensity {
    double shared = 0.0;
    double hero = 0.0;
};

/// Where a ray behind the lens (lens space) meets the film, and the density with which camera paths of a wavelength,
/// by its position in the map's band, draw it: per etendue, 1/(mm² sr), times a pixel's area.
struct FilmMeeting {
    Vec2d point;
    double density = 0.0;
};
FilmMeeting meet_film(const pupil::PupilMap& pupil, double film_z, double band_position, const Ray<double>& behind);

/// Camera paths are drawn for their hero; outside the lens the ray serves the other wavelengths too, each of which
/// reaches it by its own way through the glass, from its own point on the film. Of the four strategies "draw the ray as
/// wavelength m's hero, in this pixel" each could have drawn the ray with a density p_m of its own, 0 where its film
/// point lies outside the pixel. Weighed by the balance heuristic (Veach & Guibas 1995; Wilkie et al. 2014, eq. 8),
/// wavelength j counts
///
///     w_j = τ_j / (¼ Σ_m p_m)   if its film point lies in the pixel, else 0;
///
/// densities are per etendue, which is the same on both sides of the lens. Nothing crosses a pixel's border: what a
/// wavelength brings elsewhere, that pixel's own paths bring. A lens whose colours part by more than a pixel leaves the
/// hero alone, with w = 4 τ / p.
class SharedRays {
  public:
    /// All outlive it. `lens` at the strata of `grid`. `is_box`: pixels are the filter, as w needs it; else the pixel
    /// of a path is the one that its film point lies in, and w is for its densities alone.
    SharedRays(const spectral::SpectralGrid& grid, const optics::SpectralLens<double>& lens,
               const pupil::PupilSlices& pupil, const Sensor& sensor, bool is_box = true)
        : grid_(grid),
          lens_(&lens),
          pupil_(&pupil),
          sensor_(sensor),
          is_box_(is_box),
          rays_(kBlock * spectral::kWavelengthsPerPath) {}

    /// For every path of the buffer, w of its four wavelengths, sr.
    const std::vector<std::array<float, spectral::kWavelengthsPerPath>>& weigh(const CameraPathBuffer<double>& paths);

    /// Of the paths that were weighed last, the densities that they were drawn with: ¼ Σ_m p_m, and p of the hero.
    [[nodiscard]] const std::vector<PathDensity>& densities() const { return densities_; }

  private:
    static constexpr int kBlock = 64;  // paths; their rays stay in the first-level cache

    void trace(const CameraPathBuffer<double>& paths, int first, int count);
    [[nodiscard]] Vec2d pixel_of(const CameraPathBuffer<double>& paths, std::size_t path) const;

    const spectral::SpectralGrid& grid_;
    const optics::SpectralLens<double>* lens_;
    const pupil::PupilSlices* pupil_;
    Sensor sensor_;
    bool is_box_;
    optics::RayBatch<double> rays_;
    std::vector<std::array<float, spectral::kWavelengthsPerPath>> weights_;
    std::vector<PathDensity> densities_;
};

}  // namespace lensproof::render
