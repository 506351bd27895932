// engine/render/stray/barrel_entrance.h — light that walls inside the lens scatter, and that reaches the film.
#pragma once
#include <optional>

#include "engine/optics/barrel.h"
#include "engine/render/sampling/path_sampler.h"
#include "engine/render/stray/camera_front.h"

namespace lensproof::render {

/// Which ways light is to take.
enum class Walls {
    met,         // a wall at least once: what glass alone reflects is the ghosts'
    met_or_not,  // all ways: slow, and a judge of others
};

/// A ray is drawn evenly over the front of an exact camera; behind it each wavelength goes its own way by chance
/// (optics::StrayWalk), from the same numbers, so that most of them keep together. Nothing meets walls that are black.
class BarrelEntrance {
  public:
    static constexpr bool shows_points = true;  // spread by what scatters
    using Entry = render::Entry;

    /// Throws InputError for an ideal camera, and as `optics::Barrel` does. The camera outlives it.
    BarrelEntrance(const Camera& camera, Walls walls);

    [[nodiscard]] std::optional<Entry> draw(const LightOrigin& from, const spectral::PathWavelengths& path,
                                            bool is_hero_alone, PathSampler& numbers) const;
    [[nodiscard]] std::optional<Entry> meet(const Ray<double>& ray, const spectral::PathWavelengths& path,
                                            PathSampler& numbers) const;

  private:
    /// The entry with where its light lands: of a mirror of a sensor's several places one, by chance.
    [[nodiscard]] Entry landed(Entry entry, const Ray<double>& ray, const spectral::PathWavelengths& path,
                               const std::array<double, PathSampler::kNumbers>& seed) const;

    CameraFront front_;
    Walls walls_;
    optics::Barrel barrel_;
};

}  // namespace lensproof::render
