#include "engine/analysis/ghost_beam.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/analysis/ghost_device.h"
#include "engine/analysis/ghost_rays.h"
#include "engine/base/infinity.h"
#include "engine/optics/field_bundle.h"
#include "engine/optics/packet/ghost_lanes.h"
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

std::optional<Landing> landing(const GhostScene& scene, const optics::GhostPath& path, Vec2d offset) {
    return traced_landing(scene, path, offset);
}

std::vector<std::optional<Landing>> landings(const GhostScene& scene, const optics::GhostPath& path,
                                             std::span<const Vec2d> offsets) {
    if (scene.device) {
        if (auto found = scene.device->landings(scene, path, offsets)) {
            return *std::move(found);
        }
    }
    std::vector<std::optional<Landing>> found;
    found.reserve(offsets.size());
    for (const Vec2d offset : offsets) {
        found.push_back(traced_landing(scene, path, offset));
    }
    return found;
}

std::vector<LandingMargins> landing_margins(const GhostScene& scene, const optics::GhostPath& path,
                                            std::span<const Vec2d> offsets) {
    if (scene.device) {
        if (auto found = scene.device->margins(scene, path, offsets)) {
            return *std::move(found);
        }
    }
    std::vector<LandingMargins> found(offsets.size());
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        LandingMargins& of = found[i];
        of.arrives = trace_margins(scene, path, offsets[i], [&](double margin) { of.margins.push_back(margin); });
    }
    return found;
}

std::vector<RimRay> rim_rays(const GhostScene& scene, const optics::GhostPath& path, std::span<const Vec2d> offsets) {
    if (scene.device) {
        if (auto found = scene.device->rim_rays(scene, path, offsets)) {
            return *std::move(found);
        }
    }
    std::vector<RimRay> found;
    found.reserve(offsets.size());
    const optics::SpectralLens<double> lens({scene.lens});
    for (std::size_t first = 0; first < offsets.size(); first += optics::kFollowedRays) {
        optics::FollowedRays rays;
        const std::size_t count = std::min(optics::kFollowedRays, offsets.size() - first);
        for (std::size_t i = 0; i < optics::kFollowedRays; ++i) {
            rays.ray[i].ray = scene.beam.ray(offsets[first + std::min(i, count - 1)]);
        }
        optics::follow_ghost_rays(lens, path, scene.mirrors, rays);
        for (std::size_t i = 0; i < count; ++i) {
            found.push_back(rim_ray(scene, rays.worst[i], rays.ray[i]));
        }
    }
    return found;
}

}  // namespace lensproof::analysis
