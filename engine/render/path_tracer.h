// engine/render/path_tracer.h — the radiance that comes along a ray, by paths that start with it.
#pragma once
#include <cstdint>
#include <optional>

#include "engine/optics/ray.h"
#include "engine/render/path_sampler.h"
#include "engine/render/path_vertex.h"
#include "engine/scene/scene.h"

namespace lensproof {

/// The first surface on a path.
struct FirstSurface {
    Vec3d point;
    Vec3d normal;           // its shading normal, towards the ray's origin
    SpectralSample albedo;  // from above
};

/// What a path brought.
struct PathRadiance {
    SpectralSample radiance;  // W·m⁻²·sr⁻¹·nm⁻¹ along the ray, against its direction
    std::optional<FirstSurface> first;
    std::uint32_t rays = 0;  // that were asked of the geometry
};

/// One estimate of the radiance that arrives at `ray.origin` against `ray.direction` (world frame, mm), at the path's
/// wavelengths: unbiased but for paths of more than `max_bounces` scatterings, which are left out.
///
/// Each surface point adds what lights send there directly, found by sampling lights and by following the BSDF, weighed
/// by the balance heuristic (Veach & Guibas, SIGGRAPH 1995). `throughput` is what the path starts with: 1 at each
/// wavelength, or `hero_alone(…)` where the ray is the hero's alone. Once a direction is the hero's alone, the
/// others end, and the hero has the share of all: four times its own (Wilkie et al. 2014, §3.2).
PathRadiance trace_path(const Scene& scene, const Ray<double>& ray, const PathWavelengths& path,
                        const SpectralSample& throughput, const PathSettings& settings, PathSampler& numbers);

}  // namespace lensproof
