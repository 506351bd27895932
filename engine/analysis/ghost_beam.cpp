#include "engine/analysis/ghost_beam.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/infinity.h"
#include "engine/optics/field_bundle.h"
#include "engine/optics/surface_axes.h"

namespace lensproof::analysis {

FrontBeam::FrontBeam(const optics::TraceLens<double>& lens, double angle)
    : direction_{0.0, std::sin(angle), std::cos(angle)}, across_(optics::across_axes(direction_)) {
    const optics::TraceSurface<double>& front = lens.surfaces.front();
    const optics::SurfaceShape<double> shape = optics::shape_of(lens, front);
    const double semi_diameter = std::sqrt(front.semi_diameter_squared);
    Vec2d low{kInfinity, kInfinity};
    Vec2d high{-kInfinity, -kInfinity};
    const auto hold = [&](double r, double azimuth) {
        const auto [meeting, normal] = optics::intersect(
            shape, Vec3d{r * std::cos(azimuth), r * std::sin(azimuth), 0.0}, Vec3d{0.0, 0.0, 1.0}, 1.0);
        if (!meeting.hit) {
            return;
        }
        const Vec3d point = optics::from_own_axes(lens, front, meeting.point);
        const Vec2d offset{dot(point, across_[0]), dot(point, across_[1])};
        low = {std::min(low.x, offset.x), std::min(low.y, offset.y)};
        high = {std::max(high.x, offset.x), std::max(high.y, offset.y)};
    };
    constexpr int kRings = 16;
    constexpr int kAzimuths = 64;
    for (int ring = 0; ring <= kRings; ++ring) {
        for (int i = 0; i < kAzimuths; ++i) {
            hold(semi_diameter * ring / kRings, 2.0 * std::numbers::pi * i / kAzimuths);
        }
    }
    // Between the points that were looked at a circle bulges by half a percent.
    side_ = 1.02 * std::max(high.x - low.x, high.y - low.y);
    corner_ = 0.5 * (low + high) - Vec2d{0.5 * side_, 0.5 * side_};
}

Ray<double> FrontBeam::ray(Vec2d offset) const {
    // From well in front: a dome's light from the side first meets it there.
    return {offset.x * across_[0] + offset.y * across_[1] - 2.0 * side_ * direction_, direction_};
}

std::optional<Landing> landing(const GhostScene& scene, const optics::GhostPath& path, Vec2d offset) {
    const auto out = optics::trace_ghost(scene.lens, path, scene.beam.ray(offset), scene.mirrors);
    if (out.status != optics::RayStatus::ok || !(out.ray.direction.z > 0.0)) {
        return std::nullopt;
    }
    const Vec3d point = optics::meet_plane(out.ray, scene.lens.image_z).point;
    const Vec2d at{point.x, point.y};
    return length(at) <= scene.image_radius ? std::optional(Landing{at, out.transmittance}) : std::nullopt;
}

namespace {

/// Tells `found` in turn of the limits that the ray meets: r² and the limit's square, whether it has to be beyond, and
/// the margin at the edges of a stop that is no circle, else −1. Returns the ray behind the lens.
template <class Found>
optics::TracedRay<double> follow_limits(const GhostScene& scene, const optics::GhostPath& path, Vec2d offset,
                                        Found&& found) {
    const optics::TraceLens<double>& lens = scene.lens;
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
        const optics::SpecialSurface<double>* special = optics::special_of(lens, surface);
        if (special != nullptr && !special->mask.is_full_circle()) {
            const double scale = 1.0 / std::sqrt(surface.semi_diameter_squared);
            mask_margin = special->mask.edge_margin(scale * at.x, scale * at.y).margin;
        }
        found(Vec2d{at.x, at.y}, surface.semi_diameter_squared, by_blades, mask_margin);
    };
    return optics::trace_ghost<optics::Direction::forward, optics::Rims::follow>(lens, path, scene.beam.ray(offset),
                                                                                 scene.mirrors, compare);
}

double margin_at(Vec2d at, double limit_squared, bool by_blades, double mask_margin) {
    const double margin = 1.0 / std::sqrt(limit_squared) * std::hypot(at.x, at.y) - 1.0;
    return by_blades ? -std::max(margin, mask_margin) : std::max(margin, mask_margin);
}

bool reaches_sensor(const optics::TracedRay<double>& out) {
    return optics::gets_through(out.status) && out.ray.direction.z > 0.0;
}

}  // namespace

LandingMargins landing_margins(const GhostScene& scene, const optics::GhostPath& path, Vec2d offset) {
    LandingMargins found;
    const auto out =
        follow_limits(scene, path, offset, [&](const auto&... limit) { found.margins.push_back(margin_at(limit...)); });
    found.arrives = reaches_sensor(out);
    if (found.arrives) {
        const Vec3d point = optics::meet_plane(out.ray, scene.lens.image_z).point;
        found.margins.push_back(std::hypot(point.x, point.y) / scene.image_radius - 1.0);
    }
    return found;
}

void rim_rays(const GhostScene& scene, const optics::GhostPath& path, const std::vector<Vec2d>& offsets,
              std::vector<RimRay>& rays) {
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        RimRay& ray = rays[i];
        double margin = -1.0;
        double ratio_squared = 0.0;  // largest r² / limit², where that is all there is: roots take their time
        const auto compare = [&](Vec2d at, double limit_squared, bool by_blades, double mask_margin) {
            if (by_blades || mask_margin > -1.0) {
                margin = std::max(margin, margin_at(at, limit_squared, by_blades, mask_margin));
            } else {
                ratio_squared = std::max(ratio_squared, dot(at, at) / limit_squared);
            }
        };
        const auto out = follow_limits(scene, path, offsets[i], compare);
        ray.margin = std::max(margin, std::sqrt(ratio_squared) - 1.0);
        ray.arrives = reaches_sensor(out);
        ray.transmittance = out.transmittance;
        if (ray.arrives) {
            const Vec3d point = optics::meet_plane(out.ray, scene.lens.image_z).point;
            ray.point = {point.x, point.y};
            ray.margin = std::max(ray.margin, std::hypot(point.x, point.y) / scene.image_radius - 1.0);
        }
    }
}

}  // namespace lensproof::analysis
