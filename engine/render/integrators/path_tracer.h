// engine/render/integrators/path_tracer.h — camera paths: from the film through the lens and the scene to the lights.
#pragma once
#include <cstdint>
#include <optional>
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

/// One estimate of the radiance that arrives at `ray.origin` against `ray.direction` (world frame, mm), at the path's
/// wavelengths: unbiased but for paths of more than `max_bounces` scatterings, which are left out.
///
/// Each surface point adds what lights send there directly, found by sampling lights and by following the BSDF, weighed
/// by the power heuristic (Veach & Guibas, SIGGRAPH 1995). Where refraction parts the wavelengths the hero goes on
/// alone (Wilkie et al. 2014, §3.2).
///
/// `drawn`: what light paths bring to the camera, one for each path of each pixel, is added to this: each path counts
/// as much as mis_weight.h gives it, and this is a part of the radiance. Nothing: it is all of it.
PathRadiance trace_path(const scene::Scene& scene, const Ray<double>& ray, const spectral::PathWavelengths& path,
                        const PathSettings& settings, PathSampler& numbers, const CameraRay* drawn = nullptr);

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
    void add_path(const CameraPathBuffer& paths, std::size_t path, std::size_t pixel, FilmTile& tile) const;
    void add_features(std::size_t pixel, const spectral::PathWavelengths& strata, const FirstSurface& first,
                      FilmTile& tile) const;

    TilePaths paths_;
    std::vector<Vec3d> albedo_weights_;  // a stratum each; none without features
    View view_;
    bool is_weighed_;
};

}  // namespace lensproof::render
