#include "engine/render/sampling/packet/number_kernel.h"

namespace lensproof::render {

NumberKernels scalar_number_kernels() {
    return number_kernels_of<std::experimental::simd_abi::scalar>();
}

}  // namespace lensproof::render
