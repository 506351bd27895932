// engine/render/integrators/stray_paths.h — light that is left to chance inside the lens, from both ends.
#pragma once
#include <array>
#include <cstdint>
#include <memory>

#include "engine/pupil/rear_disc.h"
#include "engine/render/integrators/light_walk.h"
#include "engine/render/stray/walk_entrance.h"

namespace lensproof::render {

/// Where camera paths begin that go astray: film points of a pixel, and directions over the disc behind the lens.
class StrayFilm {
  public:
    explicit StrayFilm(const Camera& camera);

    struct Start {
        Ray<double> ray;      // lens space, at the wavelength's image plane
        double weight = 0.0;  // sr: over the pdf of the direction, cosine and filter weight included
    };
    /// By four numbers.
    [[nodiscard]] Start start(Vec2d pixel, double image_z, const std::array<double, 4>& numbers) const;

    [[nodiscard]] const CameraFront& front() const { return front_; }

  private:
    CameraFront front_;
    pupil::RearDisc disc_;
};

/// Calls `irradiance(pixel, path, numbers, tile)` for each sample of a tile, a path of one wavelength each.
template <class Irradiance>
void add_stray_samples(const View& view, std::uint64_t seed, const TileSamples& samples, FilmTile& tile,
                       const Irradiance& irradiance) {
    for_each_path(
        view, seed, samples,
        [&](int x, int y, std::uint32_t sample, const spectral::PathWavelengths& path, PathSampler& numbers) {
            const Vec2d pixel{static_cast<double>(x), static_cast<double>(y)};
            const float found = irradiance(pixel, path, numbers, tile);
            if (found != 0.0F) {
                constexpr auto kWavelengths = static_cast<float>(spectral::kWavelengthsPerPath);
                tile.add(tile.pixel(x, y), sample, path.index, std::array{kWavelengths * found, 0.0F, 0.0F, 0.0F});
            }
        });
}

/// Camera paths that go from the film to the front by chance (optics::StrayWalk), and on in the scene as those that
/// image do (path_tracer.h): they see a sky, a room or a lit wall for all that it sends. Light that comes straight from
/// a lamp or a sun is left to light paths, which aim at the front from one however small; but dust on the front is a
/// surface as others are, from which lights are asked.
///
/// A path has one wavelength, since each leaves the lens another way. From the first wall it goes several ways, each
/// with its share, since few lead out. A TileRenderer.
class StrayCameraPaths {
  public:
    /// Throws as WalkEntrance.
    StrayCameraPaths(const View& view, StrayClass wanted, std::uint64_t salt);

    void operator()(const TileSamples& samples, FilmTile& tile) const;

  private:
    /// The irradiance that one path brings, W·m⁻²·nm⁻¹, filter weight included.
    [[nodiscard]] float irradiance(Vec2d pixel, const spectral::PathWavelengths& path, PathSampler& numbers,
                                   FilmTile& tile) const;
    /// What lights send to a grain with its normal, over π.
    [[nodiscard]] double shining_on(const Ray<double>& dust, const spectral::PathWavelengths& path,
                                    PathSampler& numbers) const;

    View view_;
    StrayFilm film_;
    StrayClass wanted_;
    std::shared_ptr<const optics::Barrel> barrel_;
    std::uint64_t seed_;
};

/// All light of these ways: for each sample of each pixel a camera path and a light path, of which each scene path is
/// made by one. A TileRenderer.
class StrayPaths {
  public:
    StrayPaths(const View& view, StrayClass wanted, std::uint64_t salt)
        : camera_(view, wanted, salt),
          light_(view, WalkEntrance(*view.camera, wanted), salt, LightPathsKept::beside_camera_paths) {}

    void operator()(const TileSamples& samples, FilmTile& tile) const {
        camera_(samples, tile);
        light_(samples, tile);
    }

  private:
    StrayCameraPaths camera_;
    LightPaths<WalkEntrance> light_;
};

}  // namespace lensproof::render
