#include "engine/optics/packet/ghost_kernel.h"

namespace lensproof::optics {

GhostKernels baseline_ghost_kernels() {
    return {trace_lanes<GhostAbi<2>>, follow_rays<GhostAbi<2>>};
}

}  // namespace lensproof::optics
