#include "engine/render/camera/packet/path_kernels.h"

namespace lensproof::render {

const PathKernels& path_kernels(std::optional<SimdLevel> level) {
    static const LoopsByLevel<PathKernels> found([]<SimdLevel level>() { return path_kernels_at<level>(); });
    return found.at(level);
}

}  // namespace lensproof::render
