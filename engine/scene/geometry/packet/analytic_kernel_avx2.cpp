#include "engine/scene/geometry/packet/analytic_kernel.h"

namespace lensproof::scene {

AnalyticKernels avx2_analytic_kernels() {
    return analytic_kernels_of<std::experimental::simd_abi::native<double>>();
}

}  // namespace lensproof::scene
