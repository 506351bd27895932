// engine/scene/light/environment.h — a picture of all directions, as light from infinity.
#pragma once
#include <span>

#include "engine/base/basis.h"
#include "engine/base/vec.h"
#include "engine/scene/light/light_sample.h"
#include "engine/scene/light/pixel_distribution.h"
#include "engine/scene/spectra/texture.h"

namespace lensproof::scene {

/// An equirectangular picture around the scene: its rows go from `up` to the opposite, its middle row is the horizon.
/// The middle column shows the direction +x (or what stands at right angles to `up` in its stead) turned about `up` by
/// `rotate_deg`; columns to the left of it lie counter-clockwise of it as seen from above.
class Environment {
  public:
    /// `picture`: radiance, W·m⁻²·sr⁻¹·nm⁻¹. Throws InputError for one without light.
    Environment(ImageTexture picture, const Vec3d& up, double rotate_deg);

    /// A direction drawn about as often as light comes from there: a cell of some pixels by its brightness and solid
    /// angle, evenly within it (Pharr, Jakob & Humphreys, Physically Based Rendering, 4th ed., §12.5).
    [[nodiscard]] MapDraw draw(const Vec2d& numbers) const;
    /// Where the picture shows a direction.
    [[nodiscard]] MapPlace find(const Vec3d& direction) const;
    /// The same of many at a time, to the bit; `find` asks memory for them.
    void draw(std::span<const Vec2d> numbers, std::span<MapDraw> draws) const;
    void find(std::span<const Vec3d> directions, std::span<MapPlace> places) const;

    /// Asks memory for what `radiance_at` will read.
    void fetch(const MapPlace& place) const { scene::fetch(picture_, texels(place)); }
    /// Of a place that this map has told.
    [[nodiscard]] spectral::SpectralSample radiance_at(const MapPlace& place,
                                                       const spectral::PathWavelengths& path) const {
        return value_at(picture_, texels(place), path);
    }

    /// ∫ of the mean radiance over the grid and all directions, W·m⁻²·nm⁻¹.
    [[nodiscard]] double mean_power() const { return mean_power_; }

  private:
    [[nodiscard]] TexelPlace texels(const MapPlace& place) const {
        return place_at(picture_, {place.at.x, 1.0 - place.at.y});
    }

    ImageTexture picture_;
    Basis frame_;
    PixelDistribution places_;
    double mean_power_ = 0.0;
};

}  // namespace lensproof::scene
