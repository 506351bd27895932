// engine/render/path_tracer.h — the radiance that comes along a ray, by paths that start with it.
#pragma once
#include <cstdint>
#include <optional>

#include "engine/base/ray.h"
#include "engine/render/camera_end.h"
#include "engine/render/path_vertex.h"
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

/// For paths that share their work with light paths: the camera as these see it, and the density with which it drew
/// the ray (`FilmArrival::drawn`).
struct DrawnByCamera {
    const CameraEnd* end = nullptr;
    Ray<double> ray;  // lens space, away from the camera
    PathDensity density;
};

/// One estimate of the radiance that arrives at `ray.origin` against `ray.direction` (world frame, mm), at the path's
/// wavelengths: unbiased but for paths of more than `max_bounces` scatterings, which are left out.
///
/// Each surface point adds what lights send there directly, found by sampling lights and by following the BSDF, weighed
/// by the power heuristic (Veach & Guibas, SIGGRAPH 1995). Where refraction parts the wavelengths the hero goes on
/// alone (Wilkie et al. 2014, §3.2).
///
/// `drawn`: what light paths bring to the camera, one for each path of each pixel, is added to this: each path counts
/// as much as path_weight.h gives it, and this is a part of the radiance. Nothing: it is all of it.
PathRadiance trace_path(const scene::Scene& scene, const Ray<double>& ray, const spectral::PathWavelengths& path,
                        const PathSettings& settings, PathSampler& numbers, const DrawnByCamera* drawn = nullptr);

}  // namespace lensproof::render
