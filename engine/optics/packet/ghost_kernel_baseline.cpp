#include "engine/optics/packet/ghost_kernel.h"

namespace lensproof::optics {

GhostKernel baseline_ghost_kernel() {
    return trace_lanes<GhostAbi<2>>;
}

}  // namespace lensproof::optics
