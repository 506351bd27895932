#include "engine/optics/packet/ghost_kernel.h"

namespace lensproof::optics {

GhostKernel avx512_ghost_kernel() {
    return trace_lanes<GhostAbi<4>>;
}

}  // namespace lensproof::optics
