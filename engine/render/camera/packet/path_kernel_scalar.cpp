#include "engine/render/camera/packet/path_kernel.h"

namespace lensproof::render {

PathKernels scalar_path_kernels() {
    return path_kernels_of<std::experimental::simd_abi::scalar>();
}

}  // namespace lensproof::render
