// engine/optics/ghost_limits.h — how far a ray along a ghost stands from what would stop it.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/optics/ghost_path.h"
#include "engine/optics/surface_axes.h"

namespace lensproof::optics {

/// A limit that a ray on its way along a ghost has to keep to: a surface's rim and, of a stop, its edges.
struct GhostLimit {
    Vec2d at;  // in the surface's own axes
    double semi_diameter_squared = 0.0;
    bool by_blades = false;     // which are to reflect the ray
    double edge_margin = -1.0;  // of a stop that is no circle (StopOpening)

    /// r / semi-diameter − 1, or what stands for it at edges; above 0 where the ray is stopped.
    [[nodiscard]] constexpr double margin() const {
        const double margin = length(at) / std::sqrt(semi_diameter_squared) - 1.0;
        return by_blades ? -std::max(margin, edge_margin) : std::max(margin, edge_margin);
    }
};

template <class T, class Special>
constexpr GhostLimit ghost_limit(const TraceSurface<T>& surface, const Special* special, Vec2<T> at, bool by_blades) {
    GhostLimit limit{.at = at, .semi_diameter_squared = surface.semi_diameter_squared, .by_blades = by_blades};
    if (special != nullptr && !special->mask.is_full_circle()) {
        const double scale = 1.0 / std::sqrt(surface.semi_diameter_squared);
        limit.edge_margin = special->mask.edge_margin(scale * at.x, scale * at.y).margin;
    }
    return limit;
}

/// The worst of the limits that a ray has met so far.
struct WorstLimit {
    double others = -1.0;        // the margin, but for
    double ratio_squared = 0.0;  // that of rims alone, r² / semi-diameter²: roots take their time

    constexpr void meet(const GhostLimit& limit) {
        if (limit.by_blades || limit.edge_margin > -1.0) {
            others = std::max(others, limit.margin());
        } else {
            ratio_squared = std::max(ratio_squared, dot(limit.at, limit.at) / limit.semi_diameter_squared);
        }
    }
    [[nodiscard]] constexpr double margin() const { return std::max(others, std::sqrt(ratio_squared) - 1.0); }
};

/// `trace_ghost` with Rims::follow, which tells `found` in turn of the limits that the ray meets.
template <class OfLens, class Path, class Found>
constexpr TracedRay<double> follow_limits(const OfLens& lens, const Path& path, const Ray<double>& ray,
                                          const StrayMirrors<double>& mirrors, const Found& found) {
    const int sensor = static_cast<int>(lens.surfaces.size());
    auto next = path.begin();
    const auto compare = [&](const SurfaceEvent<double>& event) {
        const bool reflects = next != path.end() && *next == event.surface;
        next += reflects ? 1 : 0;
        if (event.surface == sensor) {
            return;
        }
        const TraceSurface<double>& surface = lens.surfaces[static_cast<std::size_t>(event.surface)];
        const bool by_blades = reflects && reflects_by_blades(surface);
        const Vec3d at = surface.special < 0 ? event.ray.origin : to_own_axes(lens, surface, event.ray.origin);
        constexpr double kInPlane = 1e-6;  // mm: a ray that has met the blades' plane, if not the blades
        if (event.status == RayStatus::missed &&
            !(by_blades && std::abs(surface.special < 0 ? at.z - surface.vertex_z : at.z) < kInPlane)) {
            return;  // it has no point
        }
        found(ghost_limit(surface, special_of(lens, surface), Vec2d{at.x, at.y}, by_blades));
    };
    return trace_ghost<Direction::forward, Rims::follow>(lens, path, ray, mirrors, compare);
}

}  // namespace lensproof::optics
