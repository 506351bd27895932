// engine/render/stray/ghost_entrance.h — the ways into a camera on which surfaces of its lens reflect the light.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "engine/render/sampling/path_sampler.h"
#include "engine/render/stray/camera_front.h"
#include "engine/render/stray/ghost_guide.h"

namespace lensproof::render {

/// Which ways light is to take.
enum class Reflections {
    ghosts,    // of two reflections, guided, and now and then of more
    anything,  // of any number, none too, all drawn at random: slow, and a judge of others
};

/// Light of an origin is drawn over the front of the exact camera, with the ghost that it takes; each wavelength
/// follows that by itself. A ghost that GhostGuide knows nothing of, or misses a part of, is found by a fifth of the
/// rays over the whole front and any ghost; those of four reflections and more by a tenth.
class GhostEntrance {
  public:
    using Entry = render::Entry;
    static constexpr bool shows_points = true;  // spread by what follows, other than their image

    /// Throws InputError for an ideal camera. The camera outlives it.
    GhostEntrance(const Camera& camera, Reflections reflections);

    [[nodiscard]] std::optional<Entry> draw(const LightOrigin& from, const spectral::PathWavelengths& path,
                                            bool is_hero_alone, PathSampler& numbers) const;
    [[nodiscard]] std::optional<Entry> meet(const Ray<double>& ray, const spectral::PathWavelengths& path,
                                            PathSampler& numbers) const;

  private:
    struct Way {  // that was drawn
        optics::GhostPath path;
        Vec2d offset;
        double pdf = 0.0;
    };
    /// With `of_beam` the pdf is that of the ghost and the offset, 1/mm²; else the ghost's probability, and the offset
    /// means nothing.
    [[nodiscard]] std::optional<Way> draw_way(const pupil::EntranceBeam& beam, bool of_beam,
                                              PathSampler& numbers) const;
    [[nodiscard]] std::optional<Way> draw_any(const pupil::EntranceBeam& beam, bool of_beam, std::size_t fewest,
                                              PathSampler& numbers) const;
    [[nodiscard]] std::optional<Way> draw_ghost(const pupil::EntranceBeam& beam, bool of_beam,
                                                PathSampler& numbers) const;
    [[nodiscard]] Entry followed(Entry entry, const Ray<double>& ray, const optics::GhostPath& ghost,
                                 const spectral::PathWavelengths& path) const;

    CameraFront front_;
    Reflections reflections_;
    optics::StrayMirrors<double> mirrors_;
    std::shared_ptr<const GhostGuide> guide_;
    std::vector<double> turning_;
};

}  // namespace lensproof::render
