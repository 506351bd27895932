// engine/render/stray/ghost_entrance.h — the ways into a camera on which surfaces of its lens reflect the light.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "engine/render/sampling/path_sampler.h"
#include "engine/render/stray/camera_front.h"
#include "engine/render/stray/ghost_guide.h"

namespace lensproof::render {

/// Ghosts of two reflections, through the exact camera. A ghost and a place of the front where it enters are drawn for
/// light of an origin as GhostGuide has them, and a fifth of the time any of either, since it may not know all: light
/// from near by, other wavelengths, a part of the front that its search missed. Each wavelength follows the ghost by
/// itself.
class GhostEntrance {
  public:
    using Entry = render::Entry;
    static constexpr bool shows_points = true;  // spread by what follows, other than their image

    /// `is_guided`: else any of either is drawn. Throws InputError for an ideal camera. The camera outlives it.
    explicit GhostEntrance(const Camera& camera, bool is_guided = true);

    [[nodiscard]] std::optional<Entry> draw(const LightOrigin& from, const spectral::PathWavelengths& path,
                                            bool is_hero_alone, PathSampler& numbers) const;
    [[nodiscard]] std::optional<Entry> meet(const Ray<double>& ray, const spectral::PathWavelengths& path,
                                            PathSampler& numbers) const;

    /// All of them.
    [[nodiscard]] const std::vector<optics::GhostPath>& ghosts() const { return guide_->paths(); }

  private:
    struct DrawnGhost {
        optics::GhostPath path;
        Vec2d offset;
        double pdf = 0.0;
    };
    /// With `of_beam` the pdf is that of the ghost and the offset, 1/mm²; else the ghost's probability, and the offset
    /// means nothing.
    [[nodiscard]] std::optional<DrawnGhost> draw_ghost(const pupil::EntranceBeam& beam, bool of_beam,
                                                       PathSampler& numbers) const;
    [[nodiscard]] Entry followed(Entry entry, const Ray<double>& ray, const optics::GhostPath& ghost,
                                 const spectral::PathWavelengths& path) const;

    CameraFront front_;
    optics::StrayMirrors<double> mirrors_;
    std::shared_ptr<const GhostGuide> guide_;
};

}  // namespace lensproof::render
