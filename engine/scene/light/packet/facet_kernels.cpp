#include "engine/scene/light/packet/facet_kernels.h"

namespace lensproof::scene {

const FacetKernels& facet_kernels(std::optional<SimdLevel> level) {
    static const LoopsByLevel<FacetKernels> found([]<SimdLevel level>() { return facet_kernels_at<level>(); });
    return found.at(level);
}

}  // namespace lensproof::scene
