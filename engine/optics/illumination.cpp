#include "engine/optics/illumination.h"

#include <algorithm>
#include <cmath>

#include "engine/base/infinity.h"
#include "engine/optics/rim_margin.h"

namespace lensproof::optics {

namespace {

/// Rays from a sensor point outwards, by their direction cosines (l, m).
struct SensorPoint {
    const TraceLens<double>& lens;
    Vec3d at;

    /// Nothing where the cosines are those of no ray.
    [[nodiscard]] std::optional<Ray<double>> ray(Vec2d cosines) const {
        const double z2 = 1.0 - cosines.x * cosines.x - cosines.y * cosines.y;
        return z2 > 0.0 ? std::optional(Ray<double>{at, {cosines.x, cosines.y, -std::sqrt(z2)}}) : std::nullopt;
    }

    [[nodiscard]] RegionSample margin(Vec2d cosines) const {
        const std::optional<Ray<double>> outwards = ray(cosines);
        return outwards ? rim_margin(lens, *outwards, Direction::reverse) : RegionSample{.margin = kInfinity};
    }

    [[nodiscard]] double transmittance(Vec2d cosines) const {
        return trace<Direction::reverse>(lens, *ray(cosines)).transmittance;
    }

    [[nodiscard]] RegionOutline outline(std::optional<Vec2d> towards) const {
        const TraceSurface<double>& rear = lens.surfaces.back();
        const Vec3d to_vertex = Vec3d{0.0, 0.0, rear.vertex_z} - at;
        const Vec3d to_middle = normalized(to_vertex);
        // Of a rear surface as deep as its semi-diameter, the rim is seen within twice the flat one's angle unless it
        // is close; no two cosines are farther apart than 2.
        const double reach = std::min(2.0, 2.0 * std::sqrt(rear.semi_diameter_squared) / std::abs(to_vertex.z));
        const Vec2d start = towards.value_or(Vec2d{to_middle.x, to_middle.y});
        return region_outline(
            [this](Vec2d cosines) { return margin(cosines); },
            {.start = start, .reach = reach, .is_mirror = is_mirror_symmetric(lens) && at.x == 0.0 && start.x == 0.0});
    }
};

}  // namespace

RegionOutline image_outline(const TraceLens<double>& lens, Vec2d sensor_point, std::optional<Vec2d> towards) {
    return SensorPoint{lens, {sensor_point.x, sensor_point.y, lens.image_z}}.outline(towards);
}

Bundle image_bundle(const TraceLens<double>& lens, double image_height) {
    const SensorPoint point{lens, {0.0, image_height, lens.image_z}};
    const RegionOutline outline = point.outline(std::nullopt);
    constexpr int kRings = 6;
    Bundle bundle{.projected_solid_angle = outline.area};
    for (const RegionNode& node : region_quadrature(outline, kRings)) {
        bundle.transmitted += node.weight * point.transmittance(node.point);
    }
    return bundle;
}

}  // namespace lensproof::optics
