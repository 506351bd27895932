// engine/analysis/ghost_rays.h — the rays of ghost_beam.h one by one, here and on a GPU.
//
// A scene is a GhostScene, or has its lens, beam, mirrors and image radius where a GPU finds them; a path is a list of
// surfaces.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/analysis/ghost_beam.h"
#include "engine/optics/ghost_limits.h"

namespace lensproof::analysis {

/// As `landing` has it.
template <class Scene, class Path>
constexpr std::optional<Landing> traced_landing(const Scene& scene, const Path& path, Vec2d offset) {
    const auto out = optics::trace_ghost(scene.lens, path, scene.beam.ray(offset), scene.mirrors);
    if (out.status != optics::RayStatus::ok || !(out.ray.direction.z > 0.0)) {
        return std::nullopt;
    }
    const Vec3d point = optics::meet_plane(out.ray, scene.lens.image_z).point;
    const Vec2d at{point.x, point.y};
    return length(at) <= scene.image_radius ? std::optional(Landing{at, out.transmittance}) : std::nullopt;
}

namespace ghost_rays_detail {

constexpr bool reaches_sensor(const optics::TracedRay<double>& out) {
    return optics::gets_through(out.status) && out.ray.direction.z > 0.0;
}

template <class Scene>
constexpr Vec2d image_point(const Scene& scene, const optics::TracedRay<double>& out) {
    const Vec3d point = optics::meet_plane(out.ray, scene.lens.image_z).point;
    return {point.x, point.y};
}

}  // namespace ghost_rays_detail

/// Tells `found` each of a ray's margins, as LandingMargins has them. Returns whether it arrives.
template <class Scene, class Path, class Found>
constexpr bool trace_margins(const Scene& scene, const Path& path, Vec2d offset, const Found& found) {
    const auto out = optics::follow_limits(scene.lens, path, scene.beam.ray(offset), scene.mirrors,
                                           [&](const optics::GhostLimit& limit) { found(limit.margin()); });
    if (!ghost_rays_detail::reaches_sensor(out)) {
        return false;
    }
    found(length(ghost_rays_detail::image_point(scene, out)) / scene.image_radius - 1.0);
    return true;
}

/// Of a ray behind the lens, and of the limits that it has met.
template <class Scene>
constexpr RimRay rim_ray(const Scene& scene, const optics::WorstLimit& worst, const optics::TracedRay<double>& out) {
    RimRay ray{.point = {},
               .transmittance = out.transmittance,
               .margin = worst.margin(),
               .arrives = ghost_rays_detail::reaches_sensor(out)};
    if (ray.arrives) {
        ray.point = ghost_rays_detail::image_point(scene, out);
        ray.margin = std::max(ray.margin, length(ray.point) / scene.image_radius - 1.0);
    }
    return ray;
}

template <class Scene, class Path>
constexpr RimRay traced_rim_ray(const Scene& scene, const Path& path, Vec2d offset) {
    optics::WorstLimit worst;
    const auto out = optics::follow_limits(scene.lens, path, scene.beam.ray(offset), scene.mirrors,
                                           [&](const optics::GhostLimit& limit) { worst.meet(limit); });
    return rim_ray(scene, worst, out);
}

}  // namespace lensproof::analysis
