// engine/render/stray/fate_entrance.h — what becomes of all light that comes into a camera.
#pragma once
#include <optional>

#include "engine/optics/stray_walk.h"
#include "engine/render/sampling/path_sampler.h"
#include "engine/render/stray/camera_front.h"

namespace lensproof::render {

/// Where light ends that met the first surface inside its rim: each ends once.
enum class Fate {
    imaged,    // on the film's pixels, without a reflection: what the sensor does not mirror of it
    ghosts,    // likewise, after reflections
    barrel,    // likewise, after a wall
    beside,    // behind the lens and beside the film
    front,     // out of the front, reflected there or farther inside
    clipped,   // at rims, the stop's blades and other walls
    absorbed,  // in glass and coatings
    lost,      // nowhere: through a gap in the table's walls
};
inline constexpr int kFates = 8;

/// An entrance (entry.h) onto a film of a pixel for each fate, in a row: a ray is drawn evenly over the front, each
/// wavelength goes its own way by chance (optics::StrayWalk), and arrives whole at what it ends by.
class FateEntrance {
  public:
    static constexpr bool shows_points = true;  // whatever shines
    using Entry = render::Entry;

    /// Throws InputError for an ideal camera, and as `optics::Barrel` does. The camera outlives it.
    explicit FateEntrance(const Camera& camera) : front_(camera), barrel_(camera.lens().value()) {}

    [[nodiscard]] std::optional<Entry> draw(const LightOrigin& from, const spectral::PathWavelengths& path,
                                            bool is_hero_alone, PathSampler& numbers) const;
    [[nodiscard]] std::optional<Entry> meet(const Ray<double>& ray, const spectral::PathWavelengths& path,
                                            PathSampler& numbers) const;

  private:
    [[nodiscard]] Entry ended(Entry entry, const Ray<double>& ray, const spectral::PathWavelengths& path,
                              const std::array<double, PathSampler::kNumbers>& seed) const;
    /// Nothing where the ray does not come in.
    template <class Numbers>
    [[nodiscard]] std::optional<Fate> fate(const Ray<double>& ray, const optics::TraceLens<double>& lens,
                                           Numbers& numbers) const;
    [[nodiscard]] Fate fate_behind(const optics::StrayLight& light, const optics::TraceLens<double>& lens) const;

    CameraFront front_;
    optics::Barrel barrel_;
};

}  // namespace lensproof::render
