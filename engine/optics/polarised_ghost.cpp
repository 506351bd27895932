#include "engine/optics/polarised_ghost.h"

#include "engine/optics/polarised_ray.h"

namespace lensproof::optics {

double polarisation_factor(const TraceLens<double>& lens, const GhostPath& path, const Ray<double>& ray,
                           const StrayMirrors<double>& mirrors) {
    PolarisedEvents<double> polarised(lens, path, ray.direction, Direction::forward, Rims::clip);
    const TracedRay<double> traced = trace_ghost(lens, path, ray, mirrors, polarised);
    return traced.status == RayStatus::ok ? polarised.factor() : 1.0;
}

}  // namespace lensproof::optics
