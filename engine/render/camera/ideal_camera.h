// engine/render/camera/ideal_camera.h — a camera without aberrations.
#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "engine/render/camera/camera_paths.h"
#include "engine/render/camera/film_importance.h"
#include "engine/render/camera/gaussian_optics.h"

namespace lensproof::render {

/// Gaussian optics, a stratum of the grid each. They answer what camera.h asks, in lens space, by closed forms.
///
/// Light enters through their pupil. Of the map (h, s) → (height, slope) before the lens, whose determinant is D, light
/// of a scene point at the distance Δ behind `object_z` (a negative number) that crosses the pupil at h has
/// s = (p − (h_h + Δ s_h) h) / (h_s + Δ s_s), p being the point's height, so that a pdf 1/A of h is
/// ((h_s + Δ s_s) / D)² / (A cos³ θ) per solid angle. A film point x and h, dx dh = Z² dh ds with Z from film to pupil,
/// fill the etendue D² cos⁴ θ dh ds outside; what camera paths count, cos⁴ θ' / Z² per dx dh at θ' on the film, is
/// (cos θ' / cos θ)⁴ / D² of it. A pinhole is entered through its centre and counts for all of its pupil.
class IdealCamera {
  public:
    explicit IdealCamera(std::vector<GaussianOptics> at) : at_(std::move(at)) {}

    /// The same samples on the film as an exact camera's; none is stopped. Held by it: the camera.
    class Paths {
      public:
        Paths(const IdealCamera& camera, const FilmSampling& film, const spectral::SpectralGrid& grid, PathCarry carry);

        void start(const CameraPathRange& range) { samples_.start(range); }
        bool fill(CameraPathBuffer& buffer);
        [[nodiscard]] std::int64_t started() const { return started_; }

      private:
        void weigh(CameraPathBuffer& buffer) const;

        FilmSamples samples_;
        const IdealCamera* camera_;
        IdealOpticsColumns optics_;
        const PathKernels* kernels_;
        optics::RayBatch<double> rays_;  // of the samples at hand
        std::int64_t started_ = 0;
        Sensor sensor_;
        spectral::SpectralGrid grid_;
        PathCarry carry_;
        bool is_achromatic_;  // colours take the same paths, so that one carries all wavelengths
    };

    [[nodiscard]] FilmImportance importance(const Sensor& sensor, const Ray<double>& ray,
                                            const spectral::PathWavelengths& path) const;
    [[nodiscard]] std::optional<LensSample> sample(const LightOrigin& from, const spectral::PathWavelengths& path,
                                                   double u, double v) const;
    [[nodiscard]] PathPdf pdf(const LightOrigin& from, const Ray<double>& outwards,
                              const spectral::PathWavelengths& path) const;

    [[nodiscard]] const std::vector<GaussianOptics>& at() const { return at_; }

  private:
    std::vector<GaussianOptics> at_;
};

}  // namespace lensproof::render
