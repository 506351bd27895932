// engine/render/camera/polynomial_camera.h — a camera whose lens is sparse polynomials of its own traced rays.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/polynomial/polynomial_lens.h"
#include "engine/render/camera/exact_camera.h"

namespace lensproof::render {

/// The polynomials of a lens at its strata, with the exact camera's maps of where light passes. It answers what
/// camera.h asks, in lens space: camera paths begin at the exact camera's points of film and pupil and leave by the
/// polynomials; rays that come in are drawn as the exact camera draws them, and end where the polynomials' inverse has
/// them, weighed with its own etendue. So paths from both ends make one picture, whose error is the polynomials'
/// (`polynomial().error()`).
///
/// Points that the pupil map draws in its defence lie beyond what the polynomials are fitted to and start no path: what
/// the map misses is missed. Each path carries its hero alone, whatever it is asked to: the other wavelengths' points
/// on the film would have to be found by inversion, which takes longer than tracing the lens (some 1 µs a wavelength; a
/// picture of many colours so has up to four times the exact model's variance at as many samples).
class PolynomialCamera {
  public:
    /// As ExactCamera; throws InputError as `polynomial::fit_polynomial` does.
    PolynomialCamera(const optics::Lens& lens, const std::vector<double>& wavelengths_nm, double film_radius_mm,
                     const Cache& cache, bool meets_light_paths);

    /// The same samples on film and pupil as the exact camera's.
    class Paths {
      public:
        Paths(const PolynomialCamera& camera, const FilmSampling& film, const spectral::SpectralGrid& grid,
              PathCarry carry);

        void start(const CameraPathRange& range) { samples_.start(range); }
        bool fill(CameraPathBuffer& buffer);
        [[nodiscard]] std::int64_t started() const { return started_; }

      private:
        void draw_pupil_points(PathStarts& starts);
        void append(const PathStarts& starts, CameraPathBuffer& buffer) const;
        void weigh(CameraPathBuffer& buffer) const;

        FilmSamples samples_;
        const PolynomialCamera* camera_;
        const PathKernels* kernels_;
        polynomial::PolynomialTables tables_;
        optics::RayBatch<double> rays_;
        Sensor sensor_;
        spectral::SpectralGrid grid_;
        PathCarry carry_;
        std::int64_t started_ = 0;
    };

    [[nodiscard]] FilmImportance importance(const Sensor& sensor, const Ray<double>& ray,
                                            const spectral::PathWavelengths& path) const;
    [[nodiscard]] std::optional<LensSample> sample(const LightOrigin& from, const spectral::PathWavelengths& path,
                                                   double u, double v) const {
        return exact_.sample(from, path, u, v);
    }
    [[nodiscard]] PathPdf pdf(const LightOrigin& from, const Ray<double>& outwards,
                              const spectral::PathWavelengths& path) const {
        return exact_.pdf(from, outwards, path);
    }

    [[nodiscard]] const ExactCamera& exact() const { return exact_; }
    [[nodiscard]] const polynomial::PolynomialLens& polynomial() const { return polynomial_; }

  private:
    /// Whether a pupil point's pdf, 1/mm², is that of one in the map's region.
    [[nodiscard]] bool is_in_region(double pdf) const;

    ExactCamera exact_;
    polynomial::PolynomialLens polynomial_;
};

}  // namespace lensproof::render
