// engine/scene/light/environment.h — a picture of all directions, as light from infinity.
#pragma once
#include "engine/base/basis.h"
#include "engine/base/vec.h"
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
    /// angle, evenly within it (Pharr, Jakob & Humphreys, Physically Based Rendering, 4th ed., §12.5). What
    /// `radiance_at` reads of the picture at `uv` is on its way from memory.
    struct Draw {
        Vec3d direction;
        Vec2d uv;          // of the picture
        double pdf = 0.0;  // per solid angle
    };
    [[nodiscard]] Draw draw(double u1, double u2) const;
    [[nodiscard]] spectral::SpectralSample radiance_at(const Vec2d& uv, const spectral::PathWavelengths& path) const {
        return value_at(picture_, uv, path);
    }

    /// Asks memory for what `draw` will read.
    void expect_draw(double u1, double u2) const { places_.expect(u1, u2); }

    /// Where the picture shows a direction; asks memory for what `seen` will read there.
    [[nodiscard]] Vec2d expect(const Vec3d& direction) const;

    /// What comes from a direction, which the picture shows at `uv`, and the pdf with which `draw` draws it.
    struct Seen {
        spectral::SpectralSample radiance;
        double pdf = 0.0;
    };
    [[nodiscard]] Seen seen(const Vec3d& direction, const Vec2d& uv, const spectral::PathWavelengths& path) const;
    [[nodiscard]] Seen seen(const Vec3d& direction, const spectral::PathWavelengths& path) const {
        return seen(direction, uv_of(frame_.to_local(direction)), path);
    }

    /// ∫ of the mean radiance over the grid and all directions, W·m⁻²·nm⁻¹.
    [[nodiscard]] double mean_power() const { return mean_power_; }

  private:
    /// Of a direction in the picture's frame.
    [[nodiscard]] static Vec2d uv_of(const Vec3d& local);

    ImageTexture picture_;
    Basis frame_;
    PixelDistribution places_;
    double mean_power_ = 0.0;
};

}  // namespace lensproof::scene
