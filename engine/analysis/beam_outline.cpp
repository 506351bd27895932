#include "engine/analysis/beam_outline.h"

#include <cmath>

#include "engine/optics/rim_margin.h"

namespace lensproof {

RegionOutline beam_outline(const TraceLens<double>& lens, const FieldBundle& bundle) {
    const Region region = [&](Vec2d offset) { return rim_margin(lens, bundle.ray(offset), Direction::forward); };
    const Ray<double>& chief = bundle.chief.front;
    // No two points of the first surface are farther apart than its diameter and its depth, which on a sphere is at
    // most its semi-diameter.
    const double reach = 3.0 * std::sqrt(lens.surfaces.front().semi_diameter_squared);
    const bool is_mirror = is_mirror_symmetric(lens) && chief.origin.x == 0.0 && chief.direction.x == 0.0;
    return region_outline(region, {.start = {}, .reach = reach, .is_mirror = is_mirror});
}

std::vector<BeamNode> beam_quadrature(const RegionOutline& outline, int rings) {
    std::vector<BeamNode> nodes;
    for (const RegionNode& node : region_quadrature(outline, rings)) {
        nodes.push_back({node.point, node.weight});
    }
    return nodes;
}

}  // namespace lensproof
