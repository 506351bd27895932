#include "engine/optics/packet/ghost_kernel.h"

namespace lensproof::optics {

GhostKernels scalar_ghost_kernels() {
    return {trace_lanes<GhostAbi<1>>, follow_rays<GhostAbi<1>>};
}

}  // namespace lensproof::optics
