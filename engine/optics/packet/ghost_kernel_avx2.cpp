#include "engine/optics/packet/ghost_kernel.h"

namespace lensproof::optics {

GhostKernels avx2_ghost_kernels() {
    return {trace_lanes<GhostAbi<4>>, follow_rays<GhostAbi<4>>};
}

}  // namespace lensproof::optics
