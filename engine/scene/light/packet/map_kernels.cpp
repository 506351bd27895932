#include "engine/scene/light/packet/map_kernels.h"

namespace lensproof::scene {

const MapKernels& map_kernels(std::optional<SimdLevel> level) {
    static const LoopsByLevel<MapKernels> found([]<SimdLevel level>() { return map_kernels_at<level>(); });
    return found.at(level);
}

}  // namespace lensproof::scene
