#include "engine/analysis/paraxial_rays.h"

namespace lensproof::analysis {

std::vector<RayAtSurface> ray_at_surfaces(const optics::TraceLens<double>& lens, optics::ParaxialRay ray) {
    std::vector<RayAtSurface> surfaces;
    double z = lens.surfaces.front().vertex_z;
    for (const optics::TraceSurface<double>& surface : lens.surfaces) {
        ray.height += ray.slope * (surface.vertex_z - z);
        z = surface.vertex_z;
        const double incidence = ray.slope + surface.curvature * ray.height;
        const int here = static_cast<int>(surfaces.size());
        ray = optics::trace_paraxial(lens, ray, here, here);
        surfaces.push_back({.height = ray.height, .slope = ray.slope, .incidence = incidence});
    }
    return surfaces;
}

}  // namespace lensproof::analysis
