#include "engine/scene/geometry/packet/analytic_kernels.h"

namespace lensproof::scene {

void RayColumns::set(std::size_t i, const Stretch<double>& ray) {
    origin[0][i] = ray.origin.x;
    origin[1][i] = ray.origin.y;
    origin[2][i] = ray.origin.z;
    direction[0][i] = ray.direction.x;
    direction[1][i] = ray.direction.y;
    direction[2][i] = ray.direction.z;
    from[i] = ray.from;
    to[i] = ray.to;
}

const AnalyticKernels& analytic_kernels(std::optional<SimdLevel> level) {
    static const LoopsByLevel<AnalyticKernels> found([]<SimdLevel level>() { return analytic_kernels_at<level>(); });
    return found.at(level);
}

}  // namespace lensproof::scene
