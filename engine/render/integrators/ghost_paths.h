// engine/render/integrators/ghost_paths.h — ghosts of what is seen in mirrors and through smooth glass.
#pragma once
#include <cstdint>
#include <vector>

#include "engine/render/integrators/stray_paths.h"
#include "engine/render/stray/ghost_entrance.h"

namespace lensproof::render {

/// Whether some material, in the middle of its textures, sends light one way only: then light paths find the camera by
/// chance.
bool has_mirrors(const scene::Scene& scene);

/// Camera paths that go from the film along a ghost out of the front, and on in the scene, if a mirror or smooth glass
/// is what they meet first. Each ghost is drawn as often as any other. A TileRenderer.
class MirroredGhostPaths {
  public:
    MirroredGhostPaths(const View& view, std::vector<optics::GhostPath> ghosts, std::uint64_t salt);

    void operator()(const TileSamples& samples, FilmTile& tile) const;

  private:
    [[nodiscard]] float irradiance(Vec2d pixel, const spectral::PathWavelengths& path, PathSampler& numbers,
                                   FilmTile& tile) const;

    View view_;
    StrayFilm film_;
    std::vector<optics::GhostPath> from_film_;
    std::uint64_t seed_;
};

/// The ghosts of all light, in a scene that has mirrors: for each sample of each pixel a camera path and a light path,
/// of which each scene path is made by one. A TileRenderer.
class GhostPaths {
  public:
    GhostPaths(const View& view, const GhostEntrance& entrance, std::uint64_t salt)
        : camera_(view, entrance.ghosts(), salt),
          light_(view, entrance, salt, LightPathsKept::beside_mirrored_camera_paths) {}

    void operator()(const TileSamples& samples, FilmTile& tile) const {
        camera_(samples, tile);
        light_(samples, tile);
    }

  private:
    MirroredGhostPaths camera_;
    LightPaths<GhostEntrance> light_;
};

}  // namespace lensproof::render
