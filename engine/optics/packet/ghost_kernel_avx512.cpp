#include "engine/optics/packet/ghost_kernel.h"

namespace lensproof::optics {

GhostKernels avx512_ghost_kernels() {
    return {trace_lanes<GhostAbi<4>>, follow_rays<GhostAbi<8>>};
}

}  // namespace lensproof::optics
