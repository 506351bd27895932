#include "engine/optics/packet/trace_kernel.h"

namespace lensproof::optics {

LevelKernels avx512_kernels() {
    namespace abi = std::experimental::simd_abi;
    return {.in_float = kernels_of<float, abi::native<float>>(),
            .in_double = kernels_of<double, abi::native<double>>()};
}

}  // namespace lensproof::optics
