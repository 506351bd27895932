#include "engine/analysis/beam_outline.h"

#include <cmath>

#include "engine/optics/rim_margin.h"

namespace lensproof::analysis {

optics::RegionOutline beam_outline(const optics::TraceLens<double>& lens, const optics::FieldBundle& bundle) {
    const optics::Region region = [&](Vec2d offset) {
        return optics::rim_margin(lens, bundle.ray(offset), optics::Direction::forward);
    };
    const Ray<double>& chief = bundle.chief.front;
    // No two points of the first surface are farther apart than its diameter and its depth, which on a sphere is at
    // most its semi-diameter.
    const double reach = 3.0 * std::sqrt(lens.surfaces.front().semi_diameter_squared);
    const bool is_mirror = optics::is_mirror_symmetric(lens) && chief.origin.x == 0.0 && chief.direction.x == 0.0;
    return optics::region_outline(region, {.start = {}, .reach = reach, .is_mirror = is_mirror});
}

}  // namespace lensproof::analysis
