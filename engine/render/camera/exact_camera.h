// engine/render/camera/exact_camera.h — a camera whose every ray is traced through its lens, surface by surface.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "engine/base/cache.h"
#include "engine/pupil/entrance_map.h"
#include "engine/pupil/pupil_slices.h"
#include "engine/render/camera/device_paths.h"
#include "engine/render/camera/film_importance.h"
#include "engine/render/camera/lens_paths.h"
#include "engine/render/camera/shared_rays.h"

namespace lensproof::render {

/// What rays through a lens are traced in.
enum class TracePrecision {
    in_double,
    heroes_in_double,  // and how much of a path's other wavelengths arrives in float: see BasicSharedRays
    in_float
};

/// A lens, a stratum of the grid each, with maps of where light passes it. It answers what camera.h asks, in lens
/// space: rays are drawn over the lens's front (EntranceMap) and traced forward, each wavelength by itself.
///
/// In float every ray through the glass is, outwards and inwards, in packets twice as wide; it leaves the lens some
/// ulps of a float beside the one in double, and now and then another's fate at a rim. Maps, what is drawn from them
/// and the scene are in double. Between the two, with heroes in double, all places are a double's; where paths are
/// asked for their pdfs, and of rays towards the camera, everything is in double.
///
/// Dust on the front takes from what a path counts, and changes nothing else about it.
class ExactCamera {
  public:
    /// Of film points within `film_radius_mm` of the axis. `meets_light_paths`: else `sample` and `pdf` must not be
    /// asked. `cache`: for the maps; the same come from any. `device`: finds the maps and fills buffers of paths of the
    /// box filter's, the other wavelengths of a ray aside; or null.
    ExactCamera(const optics::Lens& lens, const std::vector<double>& wavelengths_nm, double film_radius_mm,
                const Cache& cache, bool meets_light_paths, TracePrecision precision = TracePrecision::in_double,
                std::shared_ptr<device::SharedDevice> device = nullptr);
    ExactCamera(const ExactCamera&) = delete;  // slices refer to the map
    ExactCamera& operator=(const ExactCamera&) = delete;

    class Paths {
      public:
        Paths(const ExactCamera& camera, const FilmSampling& film, const spectral::SpectralGrid& grid, PathCarry carry);

        void start(const CameraPathRange& range);
        bool fill(CameraPathBuffer& buffer);
        [[nodiscard]] std::int64_t started() const;

      private:
        using Heroes =
            std::variant<BasicLensPaths<double>, BasicLensPaths<float>, DevicePaths<double>, DevicePaths<float>>;
        using Others = std::variant<BasicSharedRays<double>, BasicSharedRays<float>>;
        static Heroes heroes_of(const ExactCamera& camera, const FilmSampling& film, PathCarry carry);
        static Others others_of(const ExactCamera& camera, const FilmSampling& film, const spectral::SpectralGrid& grid,
                                PathCarry carry);

        Heroes heroes_;
        Others others_;
        const optics::FrontDust* dust_;  // or null
        PathCarry carry_;
        bool is_shared_;  // wider filters than the box draw film points unevenly: the hero stays alone
    };

    [[nodiscard]] FilmImportance importance(const Sensor& sensor, const Ray<double>& ray,
                                            const spectral::PathWavelengths& path) const;
    /// Of many rays in packets; each has the bits that it has alone.
    void importances(const Sensor& sensor, std::span<const Ray<double>> rays,
                     std::span<const spectral::PathWavelengths> paths, std::span<FilmImportance> found) const;
    [[nodiscard]] std::optional<LensSample> sample(const LightOrigin& from, const spectral::PathWavelengths& path,
                                                   double u, double v) const;
    [[nodiscard]] PathPdf pdf(const LightOrigin& from, const Ray<double>& outwards,
                              const spectral::PathWavelengths& path) const;

    [[nodiscard]] const optics::SpectralLens<double>& lens() const { return lens_; }
    [[nodiscard]] const pupil::PupilSlices& pupil() const { return slices_; }
    [[nodiscard]] TracePrecision precision() const { return precision_; }

  private:
    void put_on_device();
    [[nodiscard]] std::optional<pupil::EntranceBeam> beam_of(const LightOrigin& from) const;
    [[nodiscard]] double band_position(std::uint16_t wavelength) const;
    [[nodiscard]] PathPdf beam_pdf(const pupil::EntranceBeam& beam, Vec2d offset,
                                   const spectral::PathWavelengths& path) const;

    template <class T>
    void trace_importances(const optics::SpectralLens<T>& lens, const Sensor& sensor, std::span<const Ray<double>> rays,
                           std::span<const spectral::PathWavelengths> paths, std::span<FilmImportance> found) const;

    std::shared_ptr<device::SharedDevice> device_;
    TracePrecision precision_;
    optics::SpectralLens<double> lens_;
    std::optional<optics::SpectralLens<float>> in_float_;  // but where all is in double
    pupil::PupilMap pupil_;
    pupil::PupilSlices slices_;
    /// For far light, with a large defensive fraction: where near points' light enters lies a little beside its
    /// regions.
    std::optional<pupil::EntranceMap> entrance_;
    pupil::BoundingSphere front_;
    std::optional<optics::FrontDust> dust_;
    std::optional<std::variant<DeviceCamera<double>, DeviceCamera<float>>> on_device_;
};

}  // namespace lensproof::render
