#include "engine/optics/packet/ghost_kernel.h"

namespace lensproof::optics {

GhostKernel scalar_ghost_kernel() {
    return trace_lanes<GhostAbi<1>>;
}

}  // namespace lensproof::optics
