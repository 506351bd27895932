#include "engine/scene/geometry/packet/analytic_kernel.h"

namespace lensproof::scene {

AnalyticKernels scalar_analytic_kernels() {
    return analytic_kernels_of<std::experimental::simd_abi::scalar>();
}

}  // namespace lensproof::scene
