#include "engine/scene/geometry/packet/analytic_kernels.h"

namespace lensproof::scene {

const AnalyticKernels& analytic_kernels(std::optional<SimdLevel> level) {
    static const LoopsByLevel<AnalyticKernels> found([]<SimdLevel level>() { return analytic_kernels_at<level>(); });
    return found.at(level);
}

}  // namespace lensproof::scene
