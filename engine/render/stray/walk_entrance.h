// engine/render/stray/walk_entrance.h — light that is left to chance inside the lens, and that reaches the film.
#pragma once
#include <optional>

#include "engine/optics/stray_walk.h"
#include "engine/render/sampling/path_sampler.h"
#include "engine/render/stray/camera_front.h"

namespace lensproof::render {

/// Which of the light that is left to chance counts.
enum class StrayClass {
    many_reflections,  // four and more, and no wall: ghosts that are too many to look for one by one
    walls,             // a wall at least once
    all,               // slow, and a judge of others
};

/// Whether light is of these.
bool counts(StrayClass wanted, const optics::StrayLight& light);

/// Whether no light is: walls that are black send nothing on.
bool is_dark(StrayClass wanted, const optics::Barrel& barrel);

/// A ray is drawn evenly over the front of an exact camera; behind it each wavelength goes its own way by chance
/// (optics::StrayWalk), from the same numbers, so that most of them keep together.
class WalkEntrance {
  public:
    static constexpr bool shows_points = true;  // spread by what scatters
    using Entry = render::Entry;

    /// Throws InputError for an ideal camera, and as `optics::Barrel` does. The camera outlives it.
    WalkEntrance(const Camera& camera, StrayClass wanted);

    [[nodiscard]] std::optional<Entry> draw(const LightOrigin& from, const spectral::PathWavelengths& path,
                                            bool is_hero_alone, PathSampler& numbers) const;
    [[nodiscard]] std::optional<Entry> meet(const Ray<double>& ray, const spectral::PathWavelengths& path,
                                            PathSampler& numbers) const;

  private:
    /// The entry with where its light lands: of a mirror of a sensor's several places one, by chance.
    [[nodiscard]] Entry landed(Entry entry, const Ray<double>& ray, const spectral::PathWavelengths& path,
                               const std::array<double, PathSampler::kNumbers>& seed) const;

    CameraFront front_;
    StrayClass wanted_;
    optics::Barrel barrel_;
};

}  // namespace lensproof::render
