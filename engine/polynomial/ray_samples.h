// engine/polynomial/ray_samples.h — traced rays that polynomials are fitted to and judged by.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/optics/trace.h"
#include "engine/polynomial/exit_chart.h"
#include "engine/pupil/pupil_map.h"

namespace lensproof::polynomial {

/// A film ray, traced out of the front whatever rims it passes.
struct RaySample {
    Vec2d film;
    Vec2d pupil;
    int wavelength = 0;
    ExitPoint<double> exit;
    double transmittance = 0.0;
    bool passes = false;       // every rim
    std::vector<double> rims;  // of each surface: r² over the rim's square
    double etendue = 0.0;      // cos⁴θ / Z² over the pdf of the pupil point, sr
};

/// Where a ray's landing on the film goes with its exit: columns of ∂film/∂w and ∂film/∂u, mm.
struct LandingSlopes {
    std::array<Vec2d, 2> by_w;
    std::array<Vec2d, 2> by_u;
};

/// Draws rays of a lens over its film and pupil, from a set without end: a Kronecker sequence in radius, pupil and
/// wavelength. Film points lie on one radius; by symmetry that is all of them.
class RaySampler {
  public:
    /// `lenses`: across the band, as `pupil` has it. All outlive this.
    RaySampler(const std::vector<optics::TraceLens<double>>& lenses, const pupil::PupilMap& pupil,
               double film_radius_mm, double front_curvature)
        : lenses_(&lenses), pupil_(&pupil), film_radius_mm_(film_radius_mm), front_curvature_(front_curvature) {}

    /// Nothing where no light reaches the film, where the point was drawn in the map's defence, and where the ray does
    /// not come through.
    [[nodiscard]] std::optional<RaySample> sample(std::uint64_t number) const;
    /// `count` of them, from `first` on; fewer of a lens that lets hardly any through.
    [[nodiscard]] std::vector<RaySample> samples(std::uint64_t first, int count) const;

    /// Where a ray in front lands on the film, followed past rims; nothing where it does not come through.
    [[nodiscard]] std::optional<Vec2d> landing(const ExitPoint<double>& exit, int wavelength) const;
    [[nodiscard]] std::optional<LandingSlopes> landing_slopes(const RaySample& sample) const;

  private:
    [[nodiscard]] const optics::TraceLens<double>& lens(int wavelength) const {
        return (*lenses_)[static_cast<std::size_t>(wavelength)];
    }

    const std::vector<optics::TraceLens<double>>* lenses_;
    const pupil::PupilMap* pupil_;
    double film_radius_mm_;
    double front_curvature_;
};

}  // namespace lensproof::polynomial
