// engine/render/camera/camera.h — a camera: the paths that begin on its film, and the light that comes to it.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "engine/base/cache.h"
#include "engine/base/ray.h"
#include "engine/render/camera/camera_settings.h"
#include "engine/render/camera/exact_camera.h"
#include "engine/render/camera/ideal_camera.h"
#include "engine/render/camera/polynomial_camera.h"
#include "engine/render/camera/profile_camera.h"
#include "engine/render/film/film.h"

namespace lensproof::render {

/// Of the ray between a camera and a path's first point: the pdf with which light is brought into the camera along it,
/// over the one with which camera paths draw it (both sides' of all pixels), mm² (of light from far off sr, the former
/// then being per mm² across it). For paths that carry all wavelengths, and for those of the hero alone. 0: there are
/// no light paths, or none that may come so.
struct EntranceRatio {
    double shared = 0.0;
    double hero = 0.0;
};

/// Fills buffers with the camera paths of a range. For one thread; a copy is for another. Outlived by its camera.
class CameraPaths {
  public:
    using Optics = std::variant<ExactCamera::Paths, PolynomialCamera::Paths, IdealCamera::Paths, ProfileCamera::Paths>;
    explicit CameraPaths(Optics optics) : optics_(std::move(optics)) {}

    /// Begins a range. What was left of the one before is dropped.
    void start(const CameraPathRange& range);

    /// Replaces what is in the buffer by the next paths, as many as fit: at least one, but for the end of the range.
    /// False when none is left.
    bool fill(CameraPathBuffer& buffer);

    /// Paths that were started since the construction, those that the lens stopped included.
    [[nodiscard]] std::int64_t started() const;

  private:
    Optics optics_;
};

/// A lens or what stands for it, its film and its place in the world, at the strata of a spectral grid. Everything
/// about it is found once, for any number of renders. It stays where it was made: its paths refer to it.
///
/// Renderers ask four questions of it:
///
///   paths        which rays leave it, and what counts light that comes along them? CameraPathBuffer states the
///                estimator.
///   importance   where on the film does light end that comes along a ray, and how much of it? Its pdf is the one with
///                which `paths` draws the ray, per etendue times a pixel's area.
///   sample       along which ray may light of an origin come in? Drawn with a pdf per solid angle at the origin; of
///                far light per mm² across it.
///   pdf          with which pdf does `sample` draw this ray?
///
/// Etendue is the same on both sides of a lens, so both pdfs of a ray can be set against each other (`entrance_ratio`).
/// Nothing, or a pdf of 0: no light of the origin may come in, or `sample` cannot draw it: from points inside the
/// sphere about a lens's front, near a profile camera, or behind an ideal camera's front. A transmittance of 0: the ray
/// does not arrive. Rays are in lens space, mm, as CameraPathBuffer has them; origins in the world.
class Camera {
  public:
    /// Loads the lens. `sampling`: clamped to where its glasses are known. `cache`: for what is found by tracing it;
    /// the same pictures come from any. `meets_light_paths`: else `sample` and `pdf` must not be asked. Throws
    /// InputError as `camera_lens`, `gaussian_optics`, `traced_profile` and `polynomial::fit_polynomial` do, and for a
    /// picture of more values than fit. `device`: fills buffers of paths and finds pupils, to the same bits, where it
    /// can (SharedDevice::refuse says where not); none: the processors.
    Camera(const CameraSettings& settings, const SpectralSampling& sampling, const PixelFilter& filter,
           const Cache& cache, bool meets_light_paths = false, std::shared_ptr<device::SharedDevice> device = nullptr);
    /// The same with a lens, stopped down and focused, in the place of the one that the settings name; none where they
    /// have a focal length instead.
    Camera(const CameraSettings& settings, std::optional<optics::Lens> lens, const SpectralSampling& sampling,
           const PixelFilter& filter, const Cache& cache, bool meets_light_paths = false,
           std::shared_ptr<device::SharedDevice> device = nullptr);
    Camera(const Camera&) = delete;
    Camera& operator=(const Camera&) = delete;

    [[nodiscard]] CameraPaths paths(std::uint64_t seed, PathCarry carry) const;
    [[nodiscard]] FilmImportance importance(const Ray<double>& ray, const spectral::PathWavelengths& path) const;
    /// Of many rays, a path each, into as many of `found`.
    void importances(std::span<const Ray<double>> rays, std::span<const spectral::PathWavelengths> paths,
                     std::span<FilmImportance> found) const;
    [[nodiscard]] std::optional<LensSample> sample(const LightOrigin& from, const spectral::PathWavelengths& path,
                                                   double u, double v) const;
    [[nodiscard]] PathPdf pdf(const LightOrigin& from, const Ray<double>& outwards,
                              const spectral::PathWavelengths& path) const;

    /// For one light path to each camera path of each pixel: of the pdf of `sample` and that of `importance`.
    [[nodiscard]] EntranceRatio entrance_ratio(const PathPdf& entrance, const PathPdf& drawn) const;
    [[nodiscard]] double film_area_mm2() const;

    [[nodiscard]] const CameraSettings& settings() const { return settings_; }
    [[nodiscard]] const Sensor& sensor() const { return settings_.sensor; }
    [[nodiscard]] const std::optional<optics::Lens>& lens() const { return lens_; }
    /// Of the exact models alone.
    [[nodiscard]] const ExactCamera& exact() const { return std::get<ExactCamera>(optics_); }
    /// From the frame of pose.h to the world; and a ray from lens space there.
    [[nodiscard]] const AffineMap& pose() const { return pose_; }
    [[nodiscard]] Ray<double> to_world(const Ray<double>& ray) const {
        return {map_point(pose_, scene::camera_to_lens(ray.origin)),
                pose_.linear * scene::camera_to_lens(ray.direction)};
    }
    /// And an origin of light from there.
    [[nodiscard]] LightOrigin in_lens_space(const LightOrigin& from) const;
    [[nodiscard]] const spectral::SpectralGrid& grid() const { return grid_; }
    /// For what is found by tracing its lens.
    [[nodiscard]] const Cache& cache() const { return cache_; }
    /// Says so where wavelengths were clamped to the range of the lens's glasses; else empty.
    [[nodiscard]] const std::string& clamp_note() const { return clamp_note_; }

    /// What the film makes of light: as large as the sensor, with the response's R, G, B.
    [[nodiscard]] const FilmLayout& film() const { return film_; }
    /// RGB of a reflectance of 1 in one stratum, such that a white in the balanced light gives 1 in all of them
    /// together and each stratum's samples count alike.
    [[nodiscard]] std::vector<Vec3d> albedo_weights() const;

    /// A hash of all that rays meet in the camera, at every wavelength.
    [[nodiscard]] std::string hash() const;
    /// What a picture's file says of the camera, and the space of its R, G, B where they are not the camera's own.
    [[nodiscard]] std::map<std::string, std::string> metadata() const;
    [[nodiscard]] const std::optional<spectral::RgbSpace>& colours() const { return colours_; }

  private:
    using Optics = std::variant<ExactCamera, PolynomialCamera, IdealCamera, ProfileCamera>;
    [[nodiscard]] spectral::SpectralGrid make_grid(const SpectralSampling& sampling);
    [[nodiscard]] FilmLayout make_film(int layers, const PixelFilter& filter) const;
    [[nodiscard]] Optics make_optics(bool meets_light_paths, std::shared_ptr<device::SharedDevice> device) const;

    CameraSettings settings_;
    Cache cache_;
    AffineMap pose_;
    std::optional<optics::Lens> lens_;
    std::string clamp_note_;
    spectral::SpectralGrid grid_;
    FilmLayout film_;
    std::optional<spectral::RgbSpace> colours_;
    Optics optics_;
};

}  // namespace lensproof::render
