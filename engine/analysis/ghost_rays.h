// engine/analysis/ghost_rays.h — the rays of ghost_beam.h one by one, here and on a GPU.
//
// A scene is a GhostScene, or has its lens, beam, mirrors and image radius where a GPU finds them; a path is a list of
// surfaces.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/analysis/ghost_beam.h"
#include "engine/optics/surface_axes.h"

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

/// Tells `found` in turn of the limits that the ray meets: where, the limit's square, whether it has to be beyond, and
/// the margin at the edges of a stop that is no circle, else −1. Returns the ray behind the lens.
template <class Scene, class Path, class Found>
constexpr optics::TracedRay<double> follow_limits(const Scene& scene, const Path& path, Vec2d offset,
                                                  const Found& found) {
    const auto& lens = scene.lens;
    const int sensor = static_cast<int>(lens.surfaces.size());
    auto next = path.begin();
    const auto compare = [&](const optics::SurfaceEvent<double>& event) {
        const bool reflects = next != path.end() && *next == event.surface;
        next += reflects ? 1 : 0;
        if (event.surface == sensor) {
            return;
        }
        const optics::TraceSurface<double>& surface = lens.surfaces[static_cast<std::size_t>(event.surface)];
        const bool by_blades = reflects && optics::reflects_by_blades(surface);
        if (event.status == optics::RayStatus::missed && !by_blades) {
            return;  // it has no point; blades have been missed in their plane
        }
        const Vec3d at = surface.special < 0 ? event.ray.origin : optics::to_own_axes(lens, surface, event.ray.origin);
        double mask_margin = -1.0;
        const auto* special = optics::special_of(lens, surface);
        if (special != nullptr && !special->mask.is_full_circle()) {
            const double scale = 1.0 / std::sqrt(surface.semi_diameter_squared);
            mask_margin = special->mask.edge_margin(scale * at.x, scale * at.y).margin;
        }
        found(Vec2d{at.x, at.y}, surface.semi_diameter_squared, by_blades, mask_margin);
    };
    return optics::trace_ghost<optics::Direction::forward, optics::Rims::follow>(lens, path, scene.beam.ray(offset),
                                                                                 scene.mirrors, compare);
}

constexpr double margin_at(Vec2d at, double limit_squared, bool by_blades, double mask_margin) {
    const double margin = length(at) / std::sqrt(limit_squared) - 1.0;
    return by_blades ? -std::max(margin, mask_margin) : std::max(margin, mask_margin);
}

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
    const auto out = ghost_rays_detail::follow_limits(
        scene, path, offset, [&](Vec2d at, double limit_squared, bool by_blades, double mask_margin) {
            found(ghost_rays_detail::margin_at(at, limit_squared, by_blades, mask_margin));
        });
    if (!ghost_rays_detail::reaches_sensor(out)) {
        return false;
    }
    found(length(ghost_rays_detail::image_point(scene, out)) / scene.image_radius - 1.0);
    return true;
}

template <class Scene, class Path>
constexpr RimRay traced_rim_ray(const Scene& scene, const Path& path, Vec2d offset) {
    double margin = -1.0;
    double ratio_squared = 0.0;  // largest r² / limit², where that is all there is: roots take their time
    const auto compare = [&](Vec2d at, double limit_squared, bool by_blades, double mask_margin) {
        if (by_blades || mask_margin > -1.0) {
            margin = std::max(margin, ghost_rays_detail::margin_at(at, limit_squared, by_blades, mask_margin));
        } else {
            ratio_squared = std::max(ratio_squared, dot(at, at) / limit_squared);
        }
    };
    const auto out = ghost_rays_detail::follow_limits(scene, path, offset, compare);
    RimRay ray{.point = {},
               .transmittance = out.transmittance,
               .margin = std::max(margin, std::sqrt(ratio_squared) - 1.0),
               .arrives = ghost_rays_detail::reaches_sensor(out)};
    if (ray.arrives) {
        ray.point = ghost_rays_detail::image_point(scene, out);
        ray.margin = std::max(ray.margin, length(ray.point) / scene.image_radius - 1.0);
    }
    return ray;
}

}  // namespace lensproof::analysis
