// engine/analysis/edge_wave.h — what the wave theory has of a point's image far from that image: the light that the
// stop's edges diffract, with all its interference.
#pragma once
#include <complex>
#include <vector>

#include "engine/optics/stop_aim.h"

namespace lensproof::analysis {

/// The image of a point, or of light from far off, at one wavelength, as `SampledPupil` states it:
///     U(ξ) = ∫∫ A exp(i k Φ) dL dM,   Φ = V + L ξ + M η,
/// over the exit pupil's direction cosines, A² being T · d(beam) / dL dM here, with the transmittance T. Away from the
/// rays, whose Φ is stationary, it is a sum over the pupil's edge alone (Miyamoto & Wolf, J. Opt. Soc. Am. 52, 1962):
///     U = 1/(ik) ∮ A exp(i k Φ) (∇Φ · n) / |∇Φ|² dl,
/// in short, straight pieces, whose phase is linear (`polygon_transform`, of which this is the form with aberrations):
/// no grid, which misjudges polygons by some %. Left out is what varies over the pupil, of the order of the aberration
/// over the distance.
///
/// The stop alone bounds the beam: what rims cut off is not seen to be.
class EdgeWave {
  public:
    /// `pieces` along the whole edge, a multiple of the blades. Throws InputError where light does not reach all of the
    /// stop's edge, or the film from there.
    EdgeWave(const optics::StopAim& lens, const optics::StopMask& mask, const optics::RayOrigin& origin,
             double wavelength_nm, int pieces);

    /// Where the ray through the stop's middle meets the film, mm.
    [[nodiscard]] const Vec2d& image_point() const { return image_; }

    /// |U|² / λ² at a distance from the image point, mm: the irradiance on the film over that of far light, across it;
    /// of a point over its intensity, 1/mm².
    [[nodiscard]] double irradiance(const Vec2d& from_image) const;

  private:
    /// A point of the edge as seen in the exit pupil.
    struct Node {
        Vec2d cosines;
        Vec2d aberration;        // of its ray on the film, from the image point, mm
        double path = 0.0;       // V, mm
        double amplitude = 0.0;  // A, mm
    };

    double wavenumber_ = 0.0;  // 1/mm
    Vec2d image_;
    std::vector<Node> nodes_;
};

}  // namespace lensproof::analysis
