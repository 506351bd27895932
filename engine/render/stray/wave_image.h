// engine/render/stray/wave_image.h — the image of a distant light as waves make it.
#pragma once
#include <optional>
#include <vector>

#include "engine/analysis/psf.h"
#include "engine/base/ray.h"
#include "engine/optics/lens.h"
#include "engine/scene/light/pixel_distribution.h"

namespace lensproof::render {

/// The point spread function of a lens for light from one direction at one wavelength, from the exit pupil's amplitude
/// and phase (analysis::fft_psf), within `kReachAiry` of where the chief ray lands; drawn from. It is even over the
/// FFT's pixels.
class WaveImage {
  public:
    /// How far: in λN, which the stop's rim on the axis tells. An FFT's window is eight times as wide, so that what it
    /// repeats is at least seven times as far off: of a straight edge's streak, whose amplitude falls as 1/r, less than
    /// (1/7)² of what lies beside it.
    static constexpr double kReachAiry = 64.0;

    /// `chief`: the ray into the lens that goes through the middle of the stop. Throws InputError where the image is
    /// rays' own: where they land farther than half the reach from the chief ray, or the pupil folds.
    WaveImage(const optics::Lens& lens, const Ray<double>& chief, double wavelength_nm, double airy_mm);

    /// Where light lands, mm from the chief ray on the film, and what of all that lands within the reach goes there,
    /// over the pdf.
    struct Draw {
        Vec2d offset;
        double weight = 0.0;
    };
    [[nodiscard]] Draw draw(double u1, double u2) const;

    /// All of the light that the lens lets through to the film, over its irradiance across it.
    [[nodiscard]] double light_mm2() const { return light_mm2_; }

    /// Where a ray of it meets the first surface, lens space: drawn as the light is spread there.
    [[nodiscard]] Vec3d front(double u) const;

  private:
    struct Node {
        Vec3d front;
        double light_mm2 = 0.0;  // its own and of all before it
    };
    void integrate_light(const analysis::PolychromaticField& field, const std::optional<optics::FrontDust>& dust);
    void spread(const analysis::Psf& psf);

    static constexpr int kPixelsPerAiry = 2;  // as many as the beam on the axis needs (FftPsfSettings)
    static constexpr int kReach = static_cast<int>(kReachAiry) * kPixelsPerAiry;  // pixels
    static constexpr int kSize = 2 * kReach;                                      // pixels along each side
    static constexpr int kFft = 8 * kReach;

    double pixel_mm_ = 0.0;
    double light_mm2_ = 0.0;
    std::vector<Node> nodes_;
    std::vector<float> fractions_;  // of the light, a pixel's over its part of the square; row by row, y rising
    scene::PixelDistribution distribution_;
};

}  // namespace lensproof::render
