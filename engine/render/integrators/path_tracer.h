// engine/render/integrators/path_tracer.h — camera paths: from the film through the lens and the scene to the lights.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/ray.h"
#include "engine/render/integrators/tile_paths.h"
#include "engine/render/integrators/view.h"
#include "engine/render/sampling/path_sampler.h"
#include "engine/scene/scene.h"

namespace lensproof::render {

/// The first surface on a path.
struct FirstSurface {
    Vec3d point;
    Vec3d normal;                     // its shading normal, towards the ray's origin
    spectral::SpectralSample albedo;  // from above
};

/// What a path brought.
struct PathRadiance {
    spectral::SpectralSample radiance;  // W·m⁻²·sr⁻¹·nm⁻¹ along the ray, against its direction
    /// What the hero brought besides, after its direction had become its own alone: the other wavelengths, as heroes,
    /// could not have drawn these paths.
    float hero_radiance = 0.0F;
    std::optional<FirstSurface> first;
    std::uint32_t rays = 0;  // that were asked of the geometry
};

/// A ray as a camera drew it, for paths that share their work with light paths.
struct CameraRay {
    const Camera* camera = nullptr;
    Ray<double> ray;  // lens space, away from the camera
    PathPdf pdf;      // per etendue, times a pixel's area (Camera)
};

/// A path that is to be traced.
struct PathStart {
    Ray<double> ray;  // world frame, mm
    spectral::PathWavelengths path;
    PathSampler numbers;
    /// What light paths bring to the camera, one for each path of each pixel, is added to what is found: each path
    /// counts as much as mis_weight.h gives it, and the radiance is a part. Nothing: it is all of it.
    const CameraRay* drawn = nullptr;
    bool wants_first = false;  // PathRadiance::first
};

/// Of each start one estimate of the radiance that arrives at its ray's origin against its direction, at the path's
/// wavelengths: unbiased but for paths of more than `max_bounces` scatterings, which are left out. What a path finds
/// does not depend on those beside it; some of them are on their way at a time, and where one ends the next begins.
/// `found`: as many.
///
/// Each surface point adds what lights send there directly, found by sampling lights and by following the BSDF, weighed
/// by the power heuristic (Veach & Guibas, SIGGRAPH 1995). Where refraction parts the wavelengths the hero goes on
/// alone (Wilkie et al. 2014, §3.2).
void trace_paths(const scene::Scene& scene, const PathSettings& settings, std::span<const PathStart> starts,
                 std::span<PathRadiance> found);

/// The same of one path that nothing is added to.
PathRadiance trace_path(const scene::Scene& scene, const Ray<double>& ray, const spectral::PathWavelengths& path,
                        const PathSettings& settings, PathSampler& numbers);

/// Renders a scene by camera paths. A TileRenderer.
///
/// The estimator of the measurement equation is that of CameraPathBuffer, at four wavelengths a path: through a lens
/// each has its own path and weight (SharedRays), through a pinhole or a thin lens one path serves all. Where they
/// part, and with pixel filters wider than the box, the hero goes alone. Features: depth along the camera's axis,
/// albedo, and the shading normal in the camera's frame.
class PathTracer {
  public:
    explicit PathTracer(const View& view, Combination combination = Combination::alone);

    void operator()(const TileSamples& samples, FilmTile& tile);

  private:
    /// A path that left the lens, with what it counts.
    struct Sample {
        std::size_t pixel = 0;  // in the tile
        std::uint32_t sample = 0;
        std::array<float, spectral::kWavelengthsPerPath> weights{};
        float hero_weight = 0.0F;
    };
    static constexpr std::size_t kBatch = 512;  // a buffer's paths, so that few are the last ones on their way

    void start(const CameraPathBuffer& paths, std::size_t path, std::size_t pixel);
    void add_batch(FilmTile& tile);
    void add(std::size_t i, FilmTile& tile) const;
    void add_features(std::size_t pixel, const spectral::PathWavelengths& strata, const FirstSurface& first,
                      FilmTile& tile) const;

    TilePaths paths_;
    std::vector<Sample> samples_;   // of the batch, as the next three
    std::vector<CameraRay> drawn_;  // where they are weighed
    std::vector<PathStart> starts_;
    std::vector<PathRadiance> found_;
    std::vector<Vec3d> albedo_weights_;  // a stratum each; none without features
    View view_;
    bool is_weighed_;
};

}  // namespace lensproof::render
