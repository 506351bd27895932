// engine/render/stray/diffracted_entrance.h — light that the edges of the stop diffract on its way to the film.
#pragma once
#include <optional>
#include <vector>

#include "engine/optics/edge_rays.h"
#include "engine/optics/stop_aim.h"
#include "engine/render/sampling/path_sampler.h"
#include "engine/render/stray/camera_front.h"
#include "engine/render/stray/diffraction_settings.h"

namespace lensproof::render {

/// An entrance (entry.h): a point of the stop's edges is drawn, evenly along them; light of the origin is aimed at it,
/// and goes on along the edge's Keller cone, through the rest of the lens. It is the limit of a zone beside the edges
/// within which rays are diffracted (Steinert et al. 2011), as it becomes narrow: no ray passes it by. Each wavelength
/// is aimed and traced by itself, its deflection in proportion to it. The ray outside is the first wavelength's; the
/// others' differ by the colour error of the lens's pupil.
///
/// The rims of elements, which cut beams aslant, are taken to swallow light, not to diffract it. What goes straight on
/// through the stop keeps `geometric_fraction` of its light.
class DiffractedEntrance {
  public:
    static constexpr bool shows_points = true;  // spread light has a radiance
    using Entry = render::Entry;

    /// Throws InputError for an ideal camera, for a stop with a picture too soft to have edges, or on a face of glass,
    /// and for settings that make no sense.
    explicit DiffractedEntrance(const Camera& camera, const DiffractionSettings& settings = {});

    [[nodiscard]] std::optional<Entry> draw(const LightOrigin& from, const spectral::PathWavelengths& path,
                                            bool is_hero_alone, PathSampler& numbers) const;
    [[nodiscard]] std::optional<Entry> meet(const Ray<double>& ray, const spectral::PathWavelengths& path,
                                            PathSampler& numbers) const;

    /// The fraction of the light that goes straight on through the stop: the same at every wavelength, since
    /// deflections count in λN.
    [[nodiscard]] double geometric_fraction() const;

  private:
    struct Wavelength {
        optics::StopAim aim;
        double wavenumber = 0.0;  // at the stop, 1/mm
        optics::DeflectionRange deflections;
    };

    /// Brings a ray from the stop to the film, if it gets there.
    void land(Entry& entry, std::size_t wavelength, const Wavelength& at, const Vec2d& point,
              const optics::DiffractedRay& ray, double weight) const;

    CameraFront front_;
    double zone_width_ = 0.0;
    optics::StopMask mask_;
    double semi_diameter_ = 0.0;
    std::vector<Wavelength> at_;  // a stratum of the grid each
};

}  // namespace lensproof::render
