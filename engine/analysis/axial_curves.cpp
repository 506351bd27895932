#include "engine/analysis/axial_curves.h"

#include "engine/analysis/ray_pencil.h"
#include "engine/optics/paraxial.h"
#include "engine/optics/rim_margin.h"

namespace lensproof::analysis {

double axial_semi_diameter(const optics::TraceLens<double>& lens, const optics::FieldBundle& axis) {
    const optics::Region region = [&](Vec2d offset) {
        return optics::rim_margin(lens, axis.ray(offset), optics::Direction::forward);
    };
    if (!(region({}).margin < 0.0)) {
        return 0.0;
    }
    const double hint = 0.5 * optics::paraxial_data(lens).entrance_pupil_diameter;
    return optics::region_edge(region, {}, {0.0, 1.0}, hint).distance;
}

std::vector<AxialPoint> longitudinal_aberration(const optics::TraceLens<double>& lens, const optics::FieldBundle& axis,
                                                double semi_diameter, int count) {
    std::vector<AxialPoint> points;
    if (const std::optional<RayPencil> pencil = ray_pencil(lens, axis)) {
        points.push_back({0.0, 0.0, astigmatic_foci(*pencil, lens.image_z).tangential});
    }
    for (int i = 1; i < count && semi_diameter > 0.0; ++i) {
        const double zone = static_cast<double>(i) / (count - 1);
        const double height = zone * semi_diameter;
        const auto traced = optics::trace_past_rims(lens, axis.ray({0.0, height}));
        if (!optics::gets_through(traced.status)) {
            continue;
        }
        const Ray<double>& ray = traced.ray;
        // Parallel to the axis: infinitely far.
        const double crossing = ray.origin.z - ray.origin.y * ray.direction.z / ray.direction.y;
        points.push_back({zone, height, crossing - lens.image_z});
    }
    return points;
}

}  // namespace lensproof::analysis
