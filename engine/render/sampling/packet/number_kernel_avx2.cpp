#include "engine/render/sampling/packet/number_kernel.h"

namespace lensproof::render {

NumberKernels avx2_number_kernels() {
    return number_kernels_of<std::experimental::simd_abi::native<std::uint32_t>>();
}

}  // namespace lensproof::render
