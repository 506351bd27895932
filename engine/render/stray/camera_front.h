// engine/render/stray/camera_front.h — the front of an exact camera, where all light enters that goes astray in it.
#pragma once
#include <optional>

#include "engine/pupil/entrance_beam.h"
#include "engine/render/camera/camera.h"
#include "engine/render/stray/entry.h"

namespace lensproof::render {

/// Between the world and the beams in lens space that entrances draw from.
class CameraFront {
  public:
    /// Throws InputError for an ideal camera. The camera outlives it.
    explicit CameraFront(const Camera& camera);

    /// All light of an origin (world) that may meet the front. Nothing from inside its sphere and from straight behind.
    [[nodiscard]] std::optional<pupil::EntranceBeam> beam(const LightOrigin& from) const;

    /// The entry at an offset of the beam, drawn with `pdf`, 1/mm²; where it lands is to be found.
    [[nodiscard]] Entry entry(const LightOrigin& from, const pupil::EntranceBeam& beam, Vec2d offset, double pdf) const;

    /// A ray (world) that comes anyway, as one of far light's: nothing where it misses the front's sphere.
    struct Meeting {
        pupil::EntranceBeam beam;
        Vec2d offset;
    };
    [[nodiscard]] std::optional<Meeting> meet(const Ray<double>& ray) const;
    [[nodiscard]] Entry entry(const Ray<double>& ray, const Meeting& meeting) const;

    /// Where a ray of lens space behind the last surface lands on the film.
    [[nodiscard]] Vec2d film_px(const Ray<double>& ray, const optics::TraceLens<double>& lens) const;

    /// What dust on the front lets by, where a ray into the lens meets it or at a point of the first surface (lens
    /// space).
    [[nodiscard]] double clear(const Ray<double>& ray) const;
    [[nodiscard]] double clear(const Vec3d& front) const;

    [[nodiscard]] const Camera& camera() const { return *camera_; }
    [[nodiscard]] const optics::SpectralLens<double>& lens() const { return camera_->exact().lens(); }
    /// That at the middle of the band.
    [[nodiscard]] const optics::TraceLens<double>& middle() const { return lens().at(lens().wavelengths() / 2); }
    /// How far from the axis light lands that a pixel may see, mm.
    [[nodiscard]] double film_radius_mm() const;

  private:
    const Camera* camera_;
    pupil::BoundingSphere front_;
};

}  // namespace lensproof::render
