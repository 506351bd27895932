// engine/scene/light/environment.h — a picture of all directions, as light from infinity.
#pragma once
#include <optional>
#include <vector>

#include "engine/base/basis.h"
#include "engine/base/vec.h"
#include "engine/scene/spectra/texture.h"

namespace lensproof::scene {

/// An equirectangular picture around the scene: its rows go from `up` to the opposite, its middle row is the horizon.
/// The middle column shows the direction +x (or what stands at right angles to `up` in its stead) turned about `up` by
/// `rotate_deg`; columns to the left of it lie counter-clockwise of it as seen from above.
class Environment {
  public:
    /// `picture`: radiance, W·m⁻²·sr⁻¹·nm⁻¹. Throws InputError for one without light.
    Environment(ImageTexture picture, const Vec3d& up, double rotate_deg);

    /// Radiance from a direction (of unit length, towards the sky).
    [[nodiscard]] spectral::SpectralSample radiance(const Vec3d& direction,
                                                    const spectral::PathWavelengths& path) const;

    /// A direction drawn about as often as light comes from there: a pixel by its brightness and solid angle, evenly
    /// within it (Pharr, Jakob & Humphreys, Physically Based Rendering, 4th ed., §12.5).
    struct Draw {
        Vec3d direction;
        double pdf = 0.0;  // per solid angle
    };
    [[nodiscard]] Draw draw(double u1, double u2) const;
    [[nodiscard]] double pdf(const Vec3d& direction) const;

    /// ∫ of the mean radiance over the grid and all directions, W·m⁻²·nm⁻¹.
    [[nodiscard]] double mean_power() const { return mean_power_; }

  private:
    [[nodiscard]] Vec2d uv_of(const Vec3d& direction) const;
    /// Per uv area, of the pixel at uv.
    [[nodiscard]] double pdf_in_picture(std::size_t pixel, std::size_t row) const;

    ImageTexture picture_;
    Basis frame_;
    std::vector<double> rows_;    // cumulative over the rows, from 0 to 1; one more than there are
    std::vector<double> pixels_;  // the same within each row, row after row
    double mean_power_ = 0.0;
};

}  // namespace lensproof::scene
