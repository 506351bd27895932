#include "engine/optics/rim_margin.h"

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "engine/optics/surface_axes.h"

namespace lensproof::optics {

namespace {

template <Direction direction>
RegionSample margin_along(const TraceLens<double>& lens, const Ray<double>& ray) {
    const auto count = static_cast<int>(lens.surfaces.size());
    constexpr int kStatuses = 6;  // 1 + the last status's number, and one more
    RegionSample worst{.margin = -kInfinity};
    const auto compare = [&](const SurfaceEvent<double>& event) {
        if (event.status == RayStatus::missed) {
            return;
        }
        const TraceSurface<double>& surface = lens.surfaces[event.surface];
        const Vec3d at = to_own_axes(lens, surface, event.ray.origin);
        // Its sign is that of the tracer's comparison, to the last bit. Through a closed stop nothing passes.
        const double margin =
            surface.semi_diameter_squared > 0.0
                ? (at.x * at.x + at.y * at.y - surface.semi_diameter_squared) / surface.semi_diameter_squared
                : kInfinity;
        if (margin > worst.margin) {
            worst = {margin, event.surface};
        }
        const SpecialSurface<double>* special = special_of(lens, surface);
        if (special != nullptr && !special->mask.is_full_circle()) {
            const double scale = 1.0 / std::sqrt(surface.semi_diameter_squared);
            const auto blade = special->mask.edge_margin(scale * at.x, scale * at.y);
            if (blade.margin > worst.margin) {
                worst = {blade.margin, count * (kStatuses + blade.edge) + event.surface};
            }
        }
    };
    const TracedRay<double> traced = trace<direction, Rims::follow>(lens, ray, compare);
    if (traced.status == RayStatus::ok || worst.margin > 0.0) {
        return worst;
    }
    return {.margin = kInfinity, .limit = count * (1 + static_cast<int>(traced.status)) + traced.surface};
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

}  // namespace lensproof::optics
