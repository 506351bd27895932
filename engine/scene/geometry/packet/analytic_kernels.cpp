#include "engine/scene/geometry/packet/analytic_kernels.h"

namespace lensproof::scene {

void RayColumns::set(std::size_t i, const Stretch<double>& ray) {
    origin_x[i] = ray.origin.x;
    origin_y[i] = ray.origin.y;
    origin_z[i] = ray.origin.z;
    direction_x[i] = ray.direction.x;
    direction_y[i] = ray.direction.y;
    direction_z[i] = ray.direction.z;
    from[i] = ray.from;
    to[i] = ray.to;
}

const AnalyticKernels& analytic_kernels(std::optional<SimdLevel> level) {
    static const LoopsByLevel<AnalyticKernels> found([]<SimdLevel level>() { return analytic_kernels_at<level>(); });
    return found.at(level);
}

}  // namespace lensproof::scene
