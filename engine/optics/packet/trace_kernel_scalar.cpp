#include "engine/optics/packet/trace_kernel.h"

namespace lensproof::optics {

LevelKernels scalar_kernels() {
    namespace abi = std::experimental::simd_abi;
    return {.in_float = kernels_of<float, abi::scalar>(), .in_double = kernels_of<double, abi::scalar>()};
}

}  // namespace lensproof::optics
