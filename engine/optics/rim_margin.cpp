#include "engine/optics/rim_margin.h"

#include <algorithm>
#include <limits>

namespace lensproof {

namespace {

/// Distance² from the surface's own axis.
double height_squared(const TraceLens<double>& lens, const TraceSurface<double>& surface, const Vec3d& at) {
    if (surface.special < 0) {
        return at.x * at.x + at.y * at.y;
    }
    const SpecialSurface<double>& special = lens.specials[surface.special];
    const Vec3d own = special.to_own({at.x - special.vertex.x, at.y - special.vertex.y, at.z - surface.vertex_z});
    return own.x * own.x + own.y * own.y;
}

template <Direction direction>
RegionSample margin_along(const TraceLens<double>& lens, const Ray<double>& ray) {
    RegionSample worst{.margin = -std::numeric_limits<double>::infinity()};
    const auto compare = [&](const SurfaceEvent<double>& event) {
        if (event.status == RayStatus::missed) {
            return;
        }
        const TraceSurface<double>& surface = lens.surfaces[event.surface];
        const double margin = height_squared(lens, surface, event.ray.origin) / surface.semi_diameter_squared - 1.0;
        if (margin > worst.margin) {
            worst = {margin, event.surface};
        }
    };
    const TracedRay<double> traced = trace<direction, Rims::follow>(lens, ray, compare);
    if (traced.status == RayStatus::ok || worst.margin > 0.0) {
        return worst;
    }
    const auto count = static_cast<int>(lens.surfaces.size());
    return {.margin = std::numeric_limits<double>::infinity(),
            .limit = count * (1 + static_cast<int>(traced.status)) + traced.surface};
}

}  // namespace

RegionSample rim_margin(const TraceLens<double>& lens, const Ray<double>& ray, Direction direction) {
    return direction == Direction::forward ? margin_along<Direction::forward>(lens, ray)
                                           : margin_along<Direction::reverse>(lens, ray);
}

bool is_mirror_symmetric(const TraceLens<double>& lens) {
    return std::ranges::all_of(lens.specials, [](const SpecialSurface<double>& special) {
        return special.vertex.x == 0.0 && special.axes[0] == Vec3d{1.0, 0.0, 0.0} && special.mask.is_full_circle();
    });
}

}  // namespace lensproof
